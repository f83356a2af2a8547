// limber inspect: pictures of what a bake made: weights, edge groups, active examples.
#include "cli/command.h"
#include "cli/handle_file_names.h"
#include "cli/output.h"
#include "cli/picture_options.h"
#include "cli/pose_run.h"
#include "cli/progress_bar.h"
#include "core/vector.h"
#include "inspect/colored_character.h"
#include "inspect/group_colors.h"
#include "inspect/picture_layout.h"
#include "inspect/vertex_groups.h"
#include "load/rig_loader.h"
#include "viewer/headless.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace limber::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kWeights[] = "weights", kGroups[] = "groups", kExamples[] = "examples";

constexpr char kFooter[] =
    R"(Writes into DIR, as --what asks:
  weights   weights_<handle>.png of each handle, indigo 0 to yellow 1 with a line at each tenth, and
            weights.png with all of them, in the order of the handles
  groups    groups.png: the edge groups, which rotate and blend as one, each in its own colour
  examples  examples.png: which examples take part where, each group in their colours mixed; grey is
            the rest shape alone. At rest, or in frame N of a frames file (that of `limber solve`),
            reached through the frames before it
The band along the lower edge is the legend: the scale, or the examples from left to right.

Examples:
  limber inspect horse_baked.glb -o look/
  limber inspect horse_baked.glb -o look/ --what weights --handle tail --handle head --yaw 90
  limber inspect horse_baked.glb -o look/ --what examples --targets gallop.json --frame 40
)";

struct InspectOptions {
  std::string baked, output, targets;
  Vector<std::string> what = {kWeights, kGroups, kExamples}, handles;
  int frame = 0;
  PictureOptions picture = {.size = "640x480"};

  bool Asks(const char* name) const {
    return std::find(what.begin(), what.end(), name) != what.end();
  }
};

struct Subject {
  GltfFile file;
  std::shared_ptr<const Rig> rig;
  PoseState state;  // at rest, or as the frame says
};

Result<PoseState> Posed(const GltfFile& file, const std::shared_ptr<const Rig>& rig,
                        const InspectOptions& options) {
  PoseRunOptions run_options;
  run_options.baked = options.baked;
  run_options.targets = options.targets;
  Result<PoseState> state = CreateState(rig, run_options);
  if (!state.ok() || options.targets.empty()) return state;
  const Result<PoseRun> run = LoadPoseRun(file, run_options);
  if (!run.ok()) return run.status();
  if (static_cast<size_t>(options.frame) >= run->frames.size()) {
    return Error(StatusCode::kInvalidArgument, "%s: --frame %d: it has frames 0 to %zu",
                 options.targets.c_str(), options.frame, run->frames.size() - 1);
  }
  for (int frame = 0; frame <= options.frame; ++frame) {
    LIMBER_RETURN_IF_ERROR(ApplyFrame(run->frames[static_cast<size_t>(frame)], &*state));
    LIMBER_RETURN_IF_ERROR(state->Solve(run_options.ForSolver(*rig), nullptr));
  }
  return state;
}

Result<Subject> Load(const InspectOptions& options) {
  Result<GltfFile> file = GltfFile::Open(options.baked);
  if (!file.ok()) return file.status();
  auto rig = LoadRig(*file, {});
  if (!rig.ok()) return rig.status();
  Result<PoseState> state = Posed(*file, *rig, options);
  if (!state.ok()) return state.status();
  return Subject{std::move(file).value(), *rig, std::move(state).value()};
}

// The handles that are asked for, all where none is. kInvalidArgument for a name that none has.
Result<Vector<int>> ChosenHandles(const Rig& rig, const Vector<std::string>& names) {
  Vector<int> chosen;
  for (const std::string& name : names) {
    const int handle = rig.FindHandle(name);
    if (handle < 0) {
      std::string known;
      for (const RigHandle& each : rig.tables().handles)
        known += (known.empty() ? "" : ", ") + each.name;
      return Error(StatusCode::kInvalidArgument,
                   "--handle %s: no handle has this name; there are %s", name.c_str(),
                   known.c_str());
    }
    if (std::find(chosen.begin(), chosen.end(), handle) == chosen.end()) chosen.push_back(handle);
  }
  for (int h = 0; names.empty() && h < rig.num_handles(); ++h)
    chosen.push_back(h);
  return chosen;
}

// Draws, and keeps what was drawn until the end, when all of it is written.
class Pictures {
 public:
  Pictures(const InspectOptions& options, OutputFolder* output)
      : options_(options),
        output_(output) {}

  Status Draw(const inspect::ColoredCharacter& character, const SkinTransforms& transforms,
              std::span<const viewer::HandleDot> dots, viewer::Image* image) const {
    auto renderer = viewer::HeadlessRenderer::Create(character.Source(), options_.picture.headless);
    if (!renderer.ok()) return renderer.status();
    viewer::OrbitCamera camera = Camera(character, **renderer);
    options_.picture.Move(&camera);
    LIMBER_RETURN_IF_ERROR((*renderer)->RenderFrame(transforms, camera, dots, image));
    const Vector<std::string> messages = (*renderer)->validation_log().messages();
    if (messages.empty()) return {};
    return Error(StatusCode::kDeviceError, "a message of the Vulkan validation layers: %s",
                 messages[0].c_str());
  }

  // At rest the view is filled with the first example, else there is room for all of them.
  viewer::OrbitCamera Camera(const inspect::ColoredCharacter& character,
                             const viewer::HeadlessRenderer& renderer) const {
    if (!options_.targets.empty()) return renderer.DefaultCamera();
    const float aspect = static_cast<float>(options_.picture.headless.width) /
                         static_cast<float>(options_.picture.headless.height);
    const viewer::Bounds bounds = viewer::ShapeBounds(character.mesh, character.space, 0);
    return character.dimension == 2
               ? viewer::OrbitCamera::FrameFlat(bounds, character.space, aspect)
               : viewer::OrbitCamera::Frame(bounds, aspect);
  }

  Status Write(const std::string& name, const viewer::Image& image) {
    names_.push_back(name);
    return viewer::WritePng(output_->Stage(name), image);
  }

  const Vector<std::string>& names() const { return names_; }

 private:
  const InspectOptions& options_;
  OutputFolder* output_;
  Vector<std::string> names_;
};

Status DrawWeights(const Subject& subject, const Vector<int>& handles,
                   const viewer::HeadlessOptions& size, Pictures* pictures, ProgressBar* progress) {
  inspect::ContactSheet sheet(handles.size(), size.width, size.height);
  const Vector<std::string> names = HandleFileNames(subject.rig->tables().handles);
  for (size_t i = 0; i < handles.size(); ++i) {
    if (!progress->Update(kWeights, static_cast<double>(i) / static_cast<double>(handles.size())))
      return Error(StatusCode::kInvalidArgument, "interrupted");
    const auto h = static_cast<size_t>(handles[i]);
    viewer::HandleDot dot;
    dot.position = subject.state.target(handles[i]);
    dot.pinned = subject.rig->tables().handles[h].pinned;
    viewer::Image image;
    LIMBER_RETURN_IF_ERROR(pictures->Draw(inspect::ColorByWeight(*subject.rig, handles[i]),
                                          subject.state.transforms(), {&dot, 1}, &image));
    inspect::DrawLegend(inspect::ScaleLegend(), &image);
    LIMBER_RETURN_IF_ERROR(pictures->Write("weights_" + names[h] + ".png", image));
    sheet.Add(std::move(image));
  }
  return pictures->Write("weights.png", sheet.image());
}

Status DrawGroups(const Subject& subject, std::span<const int> groups, Pictures* pictures) {
  const auto colors =
      inspect::GroupColors(subject.rig->mesh(), groups, subject.rig->tables().num_groups);
  viewer::Image image;
  LIMBER_RETURN_IF_ERROR(pictures->Draw(inspect::ColorByGroup(*subject.rig, groups, colors),
                                        subject.state.transforms(), {}, &image));
  return pictures->Write("groups.png", image);
}

Status DrawExamples(const Subject& subject, std::span<const int> groups, Pictures* pictures) {
  const auto colors = inspect::ExampleColors(subject.rig->tables().num_shapes());
  const auto mixed = inspect::MixedByBlendWeights(subject.state.blend_weights(), colors);
  viewer::Image image;
  LIMBER_RETURN_IF_ERROR(pictures->Draw(inspect::ColorByGroup(*subject.rig, groups, mixed),
                                        subject.state.transforms(), {}, &image));
  inspect::DrawLegend(inspect::Swatches(colors), &image);
  return pictures->Write("examples.png", image);
}

std::string HexCode(const inspect::Color& color) {
  const auto bytes = inspect::ToBytes(color);
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", bytes[0], bytes[1], bytes[2]);
  return text;
}

void Report(const Subject& subject, const InspectOptions& options, const OutputFolder& output,
            const Pictures& pictures, const Console& console) {
  console.Print("inspected %s: %zu pictures in %s", subject.rig->name().c_str(),
                pictures.names().size(), output.path().c_str());
  Json legend = Json::object();
  const auto colors = inspect::ExampleColors(subject.rig->tables().num_shapes());
  for (size_t s = 0; options.Asks(kExamples) && s < colors.size(); ++s) {
    const std::string name(subject.rig->tables().shape_names[s]);
    legend[name] = HexCode(colors[s]);
    console.Print("  %s  %s", HexCode(colors[s]).c_str(), name.c_str());
  }
  console.Emit(
      {{"output", output.path().string()}, {"pictures", pictures.names()}, {"examples", legend}});
}

Status DrawAll(const Subject& subject, const InspectOptions& options, Pictures* pictures,
               ProgressBar* progress) {
  const Result<Vector<int>> handles = ChosenHandles(*subject.rig, options.handles);
  if (!handles.ok()) return handles.status();
  Vector<int> groups;
  if (options.Asks(kGroups) || options.Asks(kExamples)) {
    const auto node = static_cast<size_t>(FindRigNode(subject.file, 0));
    auto read = inspect::ReadVertexGroups(
        subject.file, subject.file.json()["nodes"][node].value("mesh", -1), *subject.rig);
    if (!read.ok()) return read.status();
    groups = std::move(read).value();
  }
  if (options.Asks(kWeights))
    LIMBER_RETURN_IF_ERROR(
        DrawWeights(subject, *handles, options.picture.headless, pictures, progress));
  if (options.Asks(kGroups)) LIMBER_RETURN_IF_ERROR(DrawGroups(subject, groups, pictures));
  if (options.Asks(kExamples)) LIMBER_RETURN_IF_ERROR(DrawExamples(subject, groups, pictures));
  return {};
}

ExitCode RunInspect(InspectOptions options, const Console& console) {
  if (const std::string wrong = options.picture.Complete(); !wrong.empty()) {
    return console.FailUsage(wrong + "; see limber inspect --help");
  }
  const Result<Subject> subject = Load(options);
  if (!subject.ok()) return console.Fail(subject.status());
  Result<OutputFolder> output = OutputFolder::Create(options.output);
  if (!output.ok()) return console.Fail(output.status());
  ProgressBar progress(console);
  Pictures pictures(options, &*output);
  const Status drawn = DrawAll(*subject, options, &pictures, &progress);
  progress.Clear();
  if (!drawn.ok()) return console.Fail(drawn);
  if (Status s = output->Publish(); !s.ok()) return console.Fail(s);
  Report(*subject, options, *output, pictures, console);
  return kSuccess;
}

}  // namespace

Command AddInspectCommand(CLI::App* parent) {
  CLI::App* app =
      parent->add_subcommand("inspect", "Draw what a bake made: weights, groups, examples");
  auto options = std::make_shared<InspectOptions>();
  app->add_option("BAKED", options->baked, "A baked .glb or .gltf")->required()->option_text(" ");
  app->add_option("-o,--output", options->output, "Folder for the pictures")
      ->required()
      ->option_text("DIR (required)");
  app->add_option("--what", options->what, "weights, groups, examples (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember({kWeights, kGroups, kExamples}))
      ->option_text("LIST");
  app->add_option("--handle", options->handles, "Only the weights of this handle (may be repeated)")
      ->option_text("NAME");
  auto* targets = app->add_option("--targets", options->targets, "A frames file that poses it")
                      ->option_text("FILE");
  app->add_option("--frame", options->frame, "Which of its frames (default 0)")
      ->check(CLI::NonNegativeNumber)
      ->needs(targets)
      ->option_text("N");
  options->picture.AddTo(app);
  app->footer(kFooter);
  return {app, [options](const Console& console) { return RunInspect(*options, console); }};
}

}  // namespace limber::cli
