// limber play: a window in which a baked character is dragged.
#include <memory>

#include "cli/command.h"
#include "viewer/play_window.h"

namespace limber::cli {
namespace {

constexpr char kFooter[] = R"(Left mouse button: drag a handle (the dots) or any point of the skin. Right button: orbit. Middle
button: pan. Wheel: zoom. R: reset. Escape: close. The sticks of a gamepad drag two handles.

Examples:
  limber play horse_baked.glb
)";

}  // namespace

Command AddPlayCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("play", "Drag a baked character in a window");
  app->footer(kFooter);
  return {app, [](const Console&) { return kSuccess; }};
}

}  // namespace limber::cli
