// A subcommand: its part of the command line, and what it does. One file each, cmd_<name>.cpp.
#pragma once

#include "cli/console.h"

#include <CLI/CLI.hpp>

#include <functional>

namespace limber::cli {

struct Command {
  CLI::App* app = nullptr;  // owned by the parent
  std::function<ExitCode(const Console&)> run;
};

// Each adds its options, help and examples to the parent.
Command AddPackCommand(CLI::App* parent);
Command AddBakeCommand(CLI::App* parent);
Command AddInfoCommand(CLI::App* parent);
Command AddBenchCommand(CLI::App* parent);
Command AddSolveCommand(CLI::App* parent);
Command AddRenderCommand(CLI::App* parent);
Command AddInspectCommand(CLI::App* parent);
Command AddPlayCommand(CLI::App* parent);

}  // namespace limber::cli
