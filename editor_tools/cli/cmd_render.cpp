// limber render: frames of handle targets -> PNG pictures, through Vulkan, without a window.
#include "cli/command.h"
#include "cli/output.h"
#include "cli/picture_options.h"
#include "cli/pose_run.h"
#include "cli/progress_bar.h"
#include "core/vector.h"
#include "viewer/headless.h"
#include "viewer/image.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <memory>

namespace limber::cli {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr char kFooter[] =
    R"(Writes DIR/frame_0000.png, frame_0001.png, ... and says what each stage of a frame cost: the solve on
the processor, skinning and drawing on the Vulkan device (a GPU, or Mesa's software device where there
is none). The frames file is that of `limber solve`.

Examples:
  limber render horse_baked.glb --targets gallop.json -o frames/
  limber render horse_baked.glb --targets gallop.json -o frames/ --size 1920x1080 --dots --yaw 40 --zoom 1.5
)";

struct RenderCommandOptions {
  PoseRunOptions run;
  PictureOptions picture = {.size = "1280x720"};
  bool dots = false;
};

// Sums over all frames, in milliseconds.
struct StageSums {
  double solve = 0, skin = 0, draw = 0, readback = 0, png = 0;
};

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Vector<viewer::HandleDot> Dots(const PoseState& state) {
  Vector<viewer::HandleDot> dots;
  for (int h = 0; h < state.rig().num_handles(); ++h) {
    if (!state.is_pinned(h)) continue;
    viewer::HandleDot dot;
    dot.position = state.target(h);
    dots.push_back(dot);
  }
  return dots;
}

Result<StageSums> RenderFrames(const PoseRun& run, const RenderCommandOptions& options,
                               viewer::HeadlessRenderer* renderer, OutputFolder* output,
                               ProgressBar* progress) {
  Result<PoseState> state = CreateState(run.rig, options.run);
  if (!state.ok()) return state.status();
  viewer::OrbitCamera camera = renderer->DefaultCamera();
  options.picture.Move(&camera);
  StageSums sums;
  viewer::Image image;
  for (size_t i = 0; i < run.frames.size(); ++i) {
    if (!progress->Update("render", double(i) / double(run.frames.size()))) {
      return Error(StatusCode::kInvalidArgument, "interrupted");
    }
    LIMBER_RETURN_IF_ERROR(ApplyFrame(run.frames[i], &*state));
    PoseReport report;
    auto start = Clock::now();
    LIMBER_RETURN_IF_ERROR(state->Solve(options.run.ForSolver(*run.rig), &report));
    sums.solve += MillisecondsSince(start);
    const auto dots = options.dots ? Dots(*state) : Vector<viewer::HandleDot>();
    LIMBER_RETURN_IF_ERROR(renderer->RenderFrame(state->transforms(), camera, dots, &image));
    sums.skin += renderer->times().skin_ms;
    sums.draw += renderer->times().draw_ms;
    sums.readback += renderer->times().readback_ms;
    start = Clock::now();
    LIMBER_RETURN_IF_ERROR(viewer::WritePng(output->Stage(FrameName(i) + ".png"), image));
    sums.png += MillisecondsSince(start);
  }
  return sums;
}

// A picture drawn against Vulkan's rules may look right here and break elsewhere.
Status CheckValidation(const viewer::HeadlessRenderer& renderer) {
  const Vector<std::string> messages = renderer.validation_log().messages();
  if (messages.empty()) return {};
  return Error(StatusCode::kDeviceError,
               "%zu messages of the Vulkan validation layers; the first: %s", messages.size(),
               messages[0].c_str());
}

void Report(const PoseRun& run, const StageSums& sums, const viewer::HeadlessRenderer& renderer,
            const OutputFolder& output, const Console& console) {
  const auto num_frames = static_cast<double>(std::max<size_t>(run.frames.size(), 1));
  console.Print("rendered %zu frames of %s on %s", run.frames.size(), run.rig->name().c_str(),
                renderer.device_name());
  console.Print("  ms a frame: solve %.3f, skin %.3f, draw %.3f (read back %.2f, PNG %.1f)",
                sums.solve / num_frames, sums.skin / num_frames, sums.draw / num_frames,
                sums.readback / num_frames, sums.png / num_frames);
  console.Print("  %s/frame_0000.png ...", output.path().c_str());
  console.Emit({{"output", output.path().string()},
                {"frames", run.frames.size()},
                {"device", renderer.device_name()},
                {"ms_per_frame",
                 {{"solve", sums.solve / num_frames},
                  {"skin", sums.skin / num_frames},
                  {"draw", sums.draw / num_frames},
                  {"readback", sums.readback / num_frames},
                  {"png", sums.png / num_frames}}}});
  console.Warn(renderer.warnings());
}

ExitCode RunRender(RenderCommandOptions options, const Console& console) {
  if (const std::string wrong = options.picture.Complete(); !wrong.empty()) {
    return console.FailUsage(wrong + "; see limber render --help");
  }
  const Result<GltfFile> file = GltfFile::Open(options.run.baked);
  if (!file.ok()) return console.Fail(file.status());
  const Result<PoseRun> run = LoadPoseRun(*file, options.run);
  if (!run.ok()) return console.Fail(run.status());
  Result<OutputFolder> output = OutputFolder::Create(options.run.output);
  if (!output.ok()) return console.Fail(output.status());
  const auto renderer =
      viewer::HeadlessRenderer::Create(*run->rig, options.run.baked, options.picture.headless);
  if (!renderer.ok()) return console.Fail(renderer.status());

  ProgressBar progress(console);
  const Result<StageSums> sums = RenderFrames(*run, options, renderer->get(), &*output, &progress);
  progress.Clear();
  if (!sums.ok()) return console.Fail(sums.status());
  if (Status s = CheckValidation(**renderer); !s.ok()) return console.Fail(s);
  if (Status s = output->Publish(); !s.ok()) return console.Fail(s);
  Report(*run, *sums, **renderer, *output, console);
  return kSuccess;
}

}  // namespace

Command AddRenderCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("render", "Drag a baked character, write pictures (PNG)");
  auto options = std::make_shared<RenderCommandOptions>();
  options->run.AddTo(app);
  options->picture.AddTo(app);
  app->add_flag("--dots", options->dots, "Draw the handles as dots");
  app->footer(kFooter);
  return {app, [options](const Console& console) { return RunRender(*options, console); }};
}

}  // namespace limber::cli
