// Runs the built limber command as a shell would, and keeps all that it said.
#pragma once

#include "core/vector.h"

#include <filesystem>
#include <string>

namespace limber::test {

struct CommandResult {
  int exit_code = -1;  // 128 + signal where a signal ended it
  std::string out, err;
};

CommandResult RunLimber(const Vector<std::string>& arguments);

// Starts it, sends `signal_number` after `delay_ms`, waits for the end.
CommandResult RunLimberAndSignal(const Vector<std::string>& arguments, int signal_number,
                                 int delay_ms);

// Every path below the folder, relative to it, sorted: to see what a failed command left behind.
Vector<std::string> FilesBelow(const std::filesystem::path& folder);

std::string ReadText(const std::filesystem::path& path);
void WriteText(const std::filesystem::path& path, const std::string& text);

}  // namespace limber::test
