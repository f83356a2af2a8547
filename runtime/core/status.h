// What every operation of Limber that can fail returns: a code for programs, one line for people.
//
// A message reads "<file>: <place>: <reason>; <what to do>" and is written by whoever knows the
// cause; callers may put the file's name in front (WithContext) but never reword it. Bad files and
// bad input always come back as a Status; assertions are for the caller's own bugs.
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace limber {

enum class StatusCode {
  kOk = 0,
  kInvalidArgument,  // the caller's input makes no sense: unknown handle name, wrong count
  kNotFound,         // a file or a named thing does not exist
  kIoError,          // the operating system refused: permission, disk full
  kMalformed,        // the file breaks its own format: truncated, out of range, NaN
  kUnsupported,      // well formed, but not something Limber reads (Draco, sparse nonsense)
  kVersionMismatch,  // baked by a version of Limber that this one does not read
  kMeshMismatch,     // the mesh was changed after it was baked
  kNoExamples,       // no morph target where one is needed
  kNoHandles,        // no handle, or none pinned
  kDegenerate,       // geometry that no answer exists for
  kLimitExceeded,    // larger than a published limit
  kOutOfMemory,      // within the limits, but this machine has not the memory
  kDeviceError,      // Vulkan or Embree failed
  kDeviceLost,       // the graphics device is gone, with all that was made with it
  kInternal,         // a bug of Limber's own
};

// The name of a code in lower snake case ("mesh_mismatch"), for logs and --json. Static storage.
const char* StatusCodeName(StatusCode code);

// Success, or a code with one line of explanation. Cheap to move; success allocates nothing.
class [[nodiscard]] Status {
 public:
  Status() = default;

  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {}

  bool ok() const { return code_ == StatusCode::kOk; }

  StatusCode code() const { return code_; }

  const std::string& message() const { return message_; }

  // The same failure with "context: " in front of its message; success stays success. Where there
  // is no memory for the message, the same code with a message that says so.
  Status WithContext(const std::string& context) const;

 private:
  StatusCode code_ = StatusCode::kOk;
  std::string message_;
};

// printf-style: Error(StatusCode::kMalformed, "accessor %d: ...", index). Text that comes from a
// file goes through Quoted or Printable (printable.h) first.
[[gnu::format(printf, 2, 3)]] Status Error(StatusCode code, const char* format, ...);

// A value, or the Status that says why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}  // NOLINT(google-explicit-constructor)

  // A success without a value is the caller's bug and comes out as kInternal.
  Result(Status status) {  // NOLINT(google-explicit-constructor)
    status_ =
        status.ok() ? Status(StatusCode::kInternal, "a result without a value") : std::move(status);
  }

  bool ok() const { return value_.has_value(); }

  const Status& status() const { return status_; }

  // Only when ok().
  T& value() & { return *value_; }

  const T& value() const& { return *value_; }

  T&& value() && { return std::move(*value_); }

  T* operator->() { return &*value_; }

  const T* operator->() const { return &*value_; }

  T& operator*() & { return *value_; }

  const T& operator*() const& { return *value_; }

 private:
  std::optional<T> value_;
  Status status_;
};

}  // namespace limber

// Hands a failed Status to the caller: LIMBER_RETURN_IF_ERROR(Check(x));
#define LIMBER_RETURN_IF_ERROR(expression)                                    \
  do {                                                                        \
    if (::limber::Status limber_status = (expression); !limber_status.ok()) { \
      return limber_status;                                                   \
    }                                                                         \
  } while (false)
