#include "core/status.h"

#include <cstdarg>
#include <cstdio>

namespace limber {

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
    case StatusCode::kDeviceError:
      return "device_error";
    case StatusCode::kInternal:
      return "internal";
  }
  return "unknown";
}

Status Status::WithContext(const std::string& context) const {
  return ok() ? *this : Status(code_, context + ": " + message_);
}

Status Error(StatusCode code, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  va_list measured;
  va_copy(measured, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, measured);
  va_end(measured);
  std::string message(length > 0 ? static_cast<size_t>(length) : 0, '\0');
  if (length > 0) {
    std::vsnprintf(message.data(), message.size() + 1, format, arguments);
  }
  va_end(arguments);
  return Status(code, std::move(message));
}

}  // namespace limber
