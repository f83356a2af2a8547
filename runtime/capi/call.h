// How a call from C ends: its result, the message, and never an exception.
#pragma once

#include "limber/limber.h"

#include "core/status.h"

#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <utility>

namespace limber::capi {

// What went wrong, if anything did.
struct CallStatus {
  CallStatus() = default;

  CallStatus(LimberResult failed, std::string why) : result(failed), message(std::move(why)) {}

  CallStatus(const Status& status);  // NOLINT(google-explicit-constructor): Limber's own become C's

  bool ok() const { return result == LIMBER_SUCCESS; }

  LimberResult result = LIMBER_SUCCESS;
  std::string message;
};

// The result and message of `body`, a CallStatus(), whatever it throws.
template <class Body>
CallStatus Catch(const Body& body) {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return {LIMBER_ERROR_OUT_OF_MEMORY, {}};
  } catch (const std::exception& exception) {
    return Status(StatusCode::kInternal, exception.what());
  } catch (...) {
    return Status(StatusCode::kInternal, "an exception that is none");
  }
}

// A Def of the caller's, brought to what this library knows: the fields that the caller's header
// had, and the defaults of those that it had not. def may be null: all defaults. *full: the
// defaults.
template <class Def>
CallStatus ReadDef(const Def* def, const char* name, Def* full) {
  if (def == nullptr) return {};
  if (def->cookie != full->cookie) {
    return {LIMBER_ERROR_STRUCT_NOT_DEFAULT,
            std::string(name) + ": does not begin with what limberDefault" + (name + 6) +
                "() gives; take that first and change what is to differ"};
  }
  if (def->struct_size < 2 * sizeof(uint32_t) || def->struct_size > sizeof(Def)) {
    return {LIMBER_ERROR_VERSION_MISMATCH,
            std::string(name) + ": of " + std::to_string(def->struct_size) +
                " bytes, this library knows " + std::to_string(sizeof(Def)) +
                "; it was compiled with a newer limber.h"};
  }
  const auto own_size = static_cast<uint32_t>(sizeof(Def));
  std::memcpy(full, def, def->struct_size);
  full->struct_size = own_size;
  return {};
}

// An array of Defs as the caller's header has them, which may be shorter than this library's.
template <class Def>
class DefArray {
 public:
  explicit DefArray(const Def* defs)
      : bytes_(reinterpret_cast<const unsigned char*>(defs)),
        size_(SizeOf(defs)) {}

  const Def* At(uint32_t i) const {
    return reinterpret_cast<const Def*>(bytes_ + size_t{i} * size_);
  }

 private:
  // A size that is none is refused where the first is read.
  static size_t SizeOf(const Def* defs) {
    return defs == nullptr || defs->struct_size > sizeof(Def) ? sizeof(Def) : defs->struct_size;
  }

  const unsigned char* bytes_;
  size_t size_;
};

}  // namespace limber::capi

// Hands a failed CallStatus to the caller.
#define LIMBER_RETURN_IF_FAILED(expression)                                             \
  do {                                                                                  \
    if (::limber::capi::CallStatus limber_failed = (expression); !limber_failed.ok()) { \
      return limber_failed;                                                             \
    }                                                                                   \
  } while (false)
