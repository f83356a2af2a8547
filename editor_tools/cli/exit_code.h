// What the limber command returns to the shell. Documented in `limber --help`; scripts rely on it.
#pragma once

#include "core/status.h"

namespace limber::cli {

enum ExitCode : int {
  kSuccess = 0,
  kFailed = 1,        // the input or the operating system does not allow it; one line says why
  kUsage = 2,         // the command line itself is wrong
  kNoDevice = 3,      // no usable Vulkan device, or no screen for a window
  kBug = 4,           // an error of Limber's own
  kInterrupted = 130  // Ctrl-C or SIGTERM; nothing half-written is left
};

// The exit code that goes with a failure.
ExitCode ExitCodeOf(const Status& status);

}  // namespace limber::cli
