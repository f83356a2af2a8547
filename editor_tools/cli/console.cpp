#include "cli/console.h"

#include "cli/interrupt.h"
#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <cstdarg>
#include <cstdio>

namespace limber::cli {
namespace {

// Names in a broken file may hold anything; a message stays one line and cannot drive a terminal.
std::string OneLine(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return text;
}

std::string Dump(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

ExitCode Report(const Console& console, ExitCode exit_code, const char* code,
                const std::string& message) {
  if (console.json) {
    console.Emit({{"error", {{"code", code}, {"message", message}}}});
  }
  std::fprintf(stderr, "limber: error: %s\n", OneLine(message).c_str());
  return exit_code;
}

}  // namespace

void Console::Print(const char* format, ...) const {
  if (json || quiet) return;
  va_list arguments;
  va_start(arguments, format);
  std::vprintf(format, arguments);
  va_end(arguments);
  std::putchar('\n');
}

void Console::Emit(const nlohmann::ordered_json& result) const {
  if (!json) return;
  std::puts(Dump(result).c_str());
}

void Console::Warn(const Vector<std::string>& warnings) const {
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "limber: warning: %s\n", OneLine(warning).c_str());
  }
}

ExitCode Console::Fail(const Status& status) const {
  if (InterruptRequested()) {
    return Report(*this, kInterrupted, "interrupted", "interrupted; nothing was written");
  }
  return Report(*this, ExitCodeOf(status), StatusCodeName(status.code()), status.message());
}

ExitCode Console::FailUsage(const std::string& message) const {
  return Report(*this, kUsage, "usage", message);
}

}  // namespace limber::cli
