#include "core/status.h"

#include "core/out_of_memory.h"

#include <cstdarg>
#include <cstdio>
#include <new>

namespace limber {
namespace {

// Short enough to lie inside a std::string: it needs no memory.
constexpr char kNoMessage[] = "out of memory";

}  // namespace

const char* StatusCodeName(StatusCode code) {
  switch (code) {
    case StatusCode::kOk:
      return "ok";
    case StatusCode::kInvalidArgument:
      return "invalid_argument";
    case StatusCode::kNotFound:
      return "not_found";
    case StatusCode::kIoError:
      return "io_error";
    case StatusCode::kMalformed:
      return "malformed";
    case StatusCode::kUnsupported:
      return "unsupported";
    case StatusCode::kVersionMismatch:
      return "version_mismatch";
    case StatusCode::kMeshMismatch:
      return "mesh_mismatch";
    case StatusCode::kNoExamples:
      return "no_examples";
    case StatusCode::kNoHandles:
      return "no_handles";
    case StatusCode::kDegenerate:
      return "degenerate";
    case StatusCode::kLimitExceeded:
      return "limit_exceeded";
    case StatusCode::kOutOfMemory:
      return "out_of_memory";
    case StatusCode::kDeviceLost:
      return "device_lost";
    case StatusCode::kDeviceError:
      return "device_error";
    case StatusCode::kInternal:
      return "internal";
  }
  return "unknown";
}

Status Status::WithContext(const std::string& context) const {
  if (ok()) return {};
  try {
    return Status(code_, context + ": " + message_);
  } catch (const std::bad_alloc&) {
    return Status(code_, kNoMessage);
  }
}

Status Error(StatusCode code, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  va_list measured;
  va_copy(measured, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, measured);
  va_end(measured);
  std::string message;
  try {
    message.resize(length > 0 ? static_cast<size_t>(length) : 0);
    if (length > 0) std::vsnprintf(message.data(), message.size() + 1, format, arguments);
  } catch (const std::bad_alloc&) {
    message = kNoMessage;
  }
  va_end(arguments);
  return Status(code, std::move(message));
}

Status OutOfMemory(std::string_view context) {
  try {
    const std::string place = context.empty() ? "" : std::string(context) + ": ";
    return Status(StatusCode::kOutOfMemory,
                  place + "there is not enough memory for it; close other programs, or reduce it");
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::kOutOfMemory, kNoMessage);
  }
}

}  // namespace limber
