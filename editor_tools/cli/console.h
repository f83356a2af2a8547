// The command's voice: results on stdout, everything else on stderr, one JSON object with --json.
#pragma once

#include "cli/exit_code.h"
#include "core/status.h"
#include "core/vector.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace limber::cli {

class Console {
 public:
  bool json = false;   // --json: stdout carries exactly one JSON object
  bool quiet = false;  // --quiet: no results and no progress for people; errors stay

  // A line of the result for people; silent with --json or --quiet.
  [[gnu::format(printf, 2, 3)]] void Print(const char* format, ...) const;
  // The result for machines; silent without --json.
  void Emit(const nlohmann::ordered_json& result) const;
  // One line each on stderr, after the work is done: a failure must stay one line.
  void Warn(const Vector<std::string>& warnings) const;

  // Says the failure, as one line on stderr or as {"error":{"code","message"}} with --json;
  // returns the exit code to end with. An interrupted run is reported as such.
  ExitCode Fail(const Status& status) const;
  ExitCode FailUsage(const std::string& message) const;
};

}  // namespace limber::cli
