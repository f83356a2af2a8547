// The limber command: author -> bake -> play from a shell.
#include "cli/command.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "core/vector.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

namespace limber::cli {
namespace {

constexpr char kDescription[] =
    "Limber bends a character the way its artist drew it: a mesh with a few example shapes is\n"
    "baked once and then follows a handful of dragged handles in real time.";

constexpr char kFooter[] = R"(The way of a character:
  limber pack rest.obj smile.obj frown.obj -o face.glb   OBJ files become one glTF (or start
                                                         from any glTF with morph targets)
  limber pack walk.glb --clip Run --count 6 -o run.glb   moments of an animation do as well
  limber bake face.glb -o face_baked.glb --auto-handles 8
  limber info face_baked.glb
  limber play face_baked.glb                             drag it
  limber solve face_baked.glb --targets frames.json -o out/
  limber render face_baked.glb --targets frames.json -o out/
  limber bench face_baked.glb                            what it costs

Each subcommand explains itself: limber bake --help

Results go to stdout, everything else to stderr; --json makes stdout one JSON object, for a
failure {"error":{"code","message"}}.
Exit codes: 0 done, 1 the input does not allow it, 2 wrong usage, 3 no Vulkan device or screen,
4 an error of Limber's own, 130 interrupted. After any but 0 no output is left half-written.)";

Vector<Command> AddCommands(CLI::App* app) {
  Vector<Command> commands = {AddPackCommand(app), AddBakeCommand(app), AddInfoCommand(app),
                              AddSolveCommand(app), AddBenchCommand(app)};
#ifdef LIMBER_WITH_VIEWER
  commands.push_back(AddRenderCommand(app));
  commands.push_back(AddInspectCommand(app));
#endif
#ifdef LIMBER_WITH_PLAY
  commands.push_back(AddPlayCommand(app));
#endif
  return commands;
}

// The deepest subcommand that was named, for the hint where to read on.
std::string HelpCommand(const Vector<Command>& commands) {
  for (const Command& command : commands) {
    if (command.app->parsed()) return "limber " + command.app->get_name() + " --help";
  }
  return "limber --help";
}

ExitCode RunParsed(const Vector<Command>& commands, const Console& console) {
  for (const Command& command : commands) {
    if (!command.app->parsed()) continue;
    try {
      return command.run(console);
    } catch (const std::bad_alloc&) {
      return console.Fail(Error(StatusCode::kLimitExceeded, "out of memory"));
    } catch (const std::exception& exception) {
      return console.Fail(Error(StatusCode::kInternal, "internal error: %s", exception.what()));
    }
  }
  return console.FailUsage("which subcommand? see limber --help");
}

int Main(int argc, char** argv) {
  CLI::App app(kDescription, "limber");
  app.footer(kFooter);
  app.set_version_flag("--version", "limber " LIMBER_VERSION);
  app.require_subcommand(0, 1);
  app.fallthrough();
  Console console;
  // Known before parsing ends, so that a wrong command line is reported in the form asked for.
  console.json = std::any_of(argv + 1, argv + argc,
                             [](const char* word) { return std::strcmp(word, "--json") == 0; });
  app.add_flag("--json", console.json, "Machine-readable result on stdout");
  app.add_flag("-q,--quiet", console.quiet, "Nothing but errors");
  const Vector<Command> commands = AddCommands(&app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return console.FailUsage(std::string(error.what()) + "; see " + HelpCommand(commands));
  }
  CatchInterrupts();
  return RunParsed(commands, console);
}

}  // namespace
}  // namespace limber::cli

int main(int argc, char** argv) {
  try {
    return limber::cli::Main(argc, argv);
  } catch (...) {
    std::fputs("limber: error: out of memory before the command could start\n", stderr);
    return limber::cli::kBug;
  }
}
