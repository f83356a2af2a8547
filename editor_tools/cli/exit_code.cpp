#include "cli/exit_code.h"

namespace limber::cli {

ExitCode ExitCodeOf(const Status& status) {
  switch (status.code()) {
    case StatusCode::kOk:
      return kSuccess;
    case StatusCode::kDeviceError:
      return kNoDevice;
    case StatusCode::kInternal:
      return kBug;
    default:
      return kFailed;
  }
}

}  // namespace limber::cli
