#include "run_limber.h"

#include "core/vector.h"
#include "support/temporary_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

namespace limber::test {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Become(const Vector<std::string>& arguments, const fs::path& out,
                         const fs::path& err) {
  const int out_file = open(out.c_str(), O_CREAT | O_WRONLY, 0600);
  const int err_file = open(err.c_str(), O_CREAT | O_WRONLY, 0600);
  dup2(out_file, STDOUT_FILENO);
  dup2(err_file, STDERR_FILENO);
  Vector<char*> words;
  std::string program = LIMBER_COMMAND;
  words.push_back(program.data());
  Vector<std::string> copies = arguments;
  for (std::string& word : copies)
    words.push_back(word.data());
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  _exit(127);
}

// Whether a program has a handler of its own for a signal, as Linux tells it; true where it does
// not tell, and where there is no such program any more.
bool Catches(pid_t program, int signal_number) {
  std::ifstream status("/proc/" + std::to_string(program) + "/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.rfind("State:", 0) == 0 && line.find('Z') != std::string::npos) return true;
    if (line.rfind("SigCgt:", 0) != 0) continue;
    return (std::stoull(line.substr(7), nullptr, 16) >> (signal_number - 1) & 1) != 0;
  }
  return true;
}

// A machine that is busy may take a second to start a program; a signal before it listens would say
// nothing of how it ends.
void WaitUntilItListens(pid_t program, int signal_number) {
  constexpr int kMostTries = 2000;
  for (int i = 0; i < kMostTries && !Catches(program, signal_number); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

}  // namespace

CommandResult RunLimberAndSignal(const Vector<std::string>& arguments, int signal_number,
                                 int delay_ms) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", err = folder.path() / "err";
  const pid_t child = fork();
  if (child == 0) Become(arguments, out, err);
  if (signal_number != 0) {
    WaitUntilItListens(child, signal_number);
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    kill(child, signal_number);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = ReadText(out);
  result.err = ReadText(err);
  return result;
}

CommandResult RunLimber(const Vector<std::string>& arguments) {
  return RunLimberAndSignal(arguments, 0, 0);
}

Vector<std::string> FilesBelow(const fs::path& folder) {
  Vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    files.push_back(entry.path().lexically_relative(folder).string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string ReadText(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void WriteText(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace limber::test
