#include "capi/call.h"

namespace limber::capi {
namespace {

LimberResult ResultOf(StatusCode code) {
  switch (code) {
    case StatusCode::kOk:
      return LIMBER_SUCCESS;
    case StatusCode::kInvalidArgument:
      return LIMBER_ERROR_INVALID_ARGUMENT;
    case StatusCode::kNotFound:
      return LIMBER_ERROR_NOT_FOUND;
    case StatusCode::kIoError:
      return LIMBER_ERROR_IO;
    case StatusCode::kMalformed:
    case StatusCode::kNoExamples:
    case StatusCode::kNoHandles:
    case StatusCode::kDegenerate:
      return LIMBER_ERROR_MALFORMED;
    case StatusCode::kUnsupported:
      return LIMBER_ERROR_UNSUPPORTED;
    case StatusCode::kVersionMismatch:
      return LIMBER_ERROR_VERSION_MISMATCH;
    case StatusCode::kMeshMismatch:
      return LIMBER_ERROR_MESH_MISMATCH;
    case StatusCode::kLimitExceeded:
      return LIMBER_ERROR_LIMIT_EXCEEDED;
    case StatusCode::kOutOfMemory:
      return LIMBER_ERROR_OUT_OF_MEMORY;
    case StatusCode::kDeviceError:
      return LIMBER_ERROR_DEVICE;
    case StatusCode::kDeviceLost:
      return LIMBER_ERROR_DEVICE_LOST;
    case StatusCode::kInternal:
      break;
  }
  return LIMBER_ERROR_INTERNAL;
}

}  // namespace

CallStatus::CallStatus(const Status& status) : result(ResultOf(status.code())) {
  if (!status.ok()) message = status.message();
}

}  // namespace limber::capi

extern "C" const char* limberResultString(LimberResult result) {
  switch (result) {
    case LIMBER_SUCCESS:
      return "success";
    case LIMBER_ERROR_INVALID_ARGUMENT:
      return "invalid_argument";
    case LIMBER_ERROR_STALE_ID:
      return "stale_id";
    case LIMBER_ERROR_STRUCT_NOT_DEFAULT:
      return "struct_not_default";
    case LIMBER_ERROR_NOT_FOUND:
      return "not_found";
    case LIMBER_ERROR_IO:
      return "io";
    case LIMBER_ERROR_MALFORMED:
      return "malformed";
    case LIMBER_ERROR_UNSUPPORTED:
      return "unsupported";
    case LIMBER_ERROR_VERSION_MISMATCH:
      return "version_mismatch";
    case LIMBER_ERROR_MESH_MISMATCH:
      return "mesh_mismatch";
    case LIMBER_ERROR_LIMIT_EXCEEDED:
      return "limit_exceeded";
    case LIMBER_ERROR_OUT_OF_MEMORY:
      return "out_of_memory";
    case LIMBER_ERROR_DEVICE:
      return "device";
    case LIMBER_ERROR_INTERNAL:
      return "internal";
    case LIMBER_ERROR_DEVICE_LOST:
      return "device_lost";
    default:
      return "unknown";
  }
}
