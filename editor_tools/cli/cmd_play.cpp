// limber play: a window in which a baked character is dragged.
#include "cli/command.h"
#include "cli/picture_size.h"
#include "viewer/play_window.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace limber::cli {
namespace {

constexpr char kExamples[] = R"(
Examples:
  limber play horse_baked.glb
  limber play horse_baked.glb --size 1920x1080 --iterations 3
)";

struct PlayCommandOptions {
  viewer::PlayOptions play;
  std::string size = "1280x800";
};

ExitCode RunPlayCommand(PlayCommandOptions options, const Console& console) {
  const std::string wrong = ParseSize(options.size, &options.play.width, &options.play.height);
  if (!wrong.empty()) return console.FailUsage(wrong + "; see limber play --help");
  if (Status s = viewer::RunPlay(options.play); !s.ok()) return console.Fail(s);
  console.Emit({{"played", options.play.path}});
  return kSuccess;
}

}  // namespace

Command AddPlayCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("play", "Drag a baked character in a window");
  auto options = std::make_shared<PlayCommandOptions>();
  viewer::PlayOptions& play = options->play;
  app->add_option("BAKED", play.path, "A glTF written by limber bake")
      ->required()
      ->option_text(" ");
  app->add_option("--size", options->size, "Size of the window (default 1280x800)")
      ->option_text("WxH");
  app->add_option("--iterations", play.iterations,
                  "Alternations of the solver a step; a frame takes as many steps as fit, until "
                  "nothing moves (default 1)")
      ->check(CLI::Range(1, 100000))
      ->option_text("N");
  app->add_option("--lambda", play.lambda, "Weight of nearness to the examples (default 0.5)")
      ->check(CLI::Range(0.0f, 1e6f))
      ->option_text("X");
  app->add_option("--frames", play.max_frames,
                  "Close after this many frames, with one step each at most")
      ->check(CLI::Range(1, 1000000000))
      ->option_text("N");
  app->add_option("--screenshot", play.screenshot_path, "Write the last picture as PNG")
      ->option_text("FILE");
  app->add_flag("--validate", play.validation,
                "Run with the Vulkan validation layers; any message is a failure");
  app->footer(std::string(viewer::kPlayHelp) + kExamples);
  return {app, [options](const Console& console) { return RunPlayCommand(*options, console); }};
}

}  // namespace limber::cli
