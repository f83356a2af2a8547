// limber solve: frames of handle targets -> deformed meshes as OBJ, and what the solver did.
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/obj_text.h"
#include "cli/output.h"
#include "cli/pose_run.h"
#include "cli/progress_bar.h"
#include "core/vector.h"
#include "import/file_output.h"
#include "load/rig_loader.h"
#include "skin/cpu_skinner.h"

#include <nlohmann/json.hpp>

#include <array>
#include <chrono>
#include <memory>

namespace limber::cli {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr char kReportName[] = "solve.json";

constexpr char kFooter[] = R"(Writes DIR/frame_0000.obj, frame_0001.obj, ... and DIR/solve.json:
  {"frames":[{"positions":"frame_0000.obj","blend_weights":[[per shape], ... per edge group],
              "energy":e,"iterations":n,"settled":true or false,"change":c,"optimality":o,
              "seconds":t}]}
The meshes have the vertices and faces of the source, in the source's order. "seconds" is the time
of the solve alone; "change" that of the last alternation, "optimality" what the blend weights lack
to their optimum (0: nothing). frames.json holds targets in the mesh's own space:
  {"frames":[{"targets":{"hand":[0.1,1.2,0.3],"foot":[0,0,0]}},{"targets":{"hand":[0.2,1.2,0.3]}}]}
A handle that a frame leaves out keeps its last target; before the first one it rests. Frames follow
each other: each starts from the result of the one before. Beside "targets" a frame may say
  "pinned":{"foot":false}             let go of a handle, or hold one where it is
  "stiffness":{"hand":5}              pull softly (null: exactly)
  "weights":{"foot":9}                how little it gives way to --stretch-limit (null: never; else 1)
  "rotations":{"hand":[0,0,0.4,0.9]}  turn the skin around a handle (x, y, z, w; null: let it be)

Examples:
  limber solve horse_baked.glb --targets gallop.json -o out/
  limber solve face_baked.glb --targets smile.json -o out/ --no-rotations
  limber solve horse_baked.glb --targets pose.json -o out/ --settle
)";

struct FrameResult {
  PoseReport report;
  double seconds = 0;
};

Result<FrameResult> SolveFrame(const PoseFrame& frame, const PoseOptions& options,
                               PoseState* state) {
  FrameResult result;
  LIMBER_RETURN_IF_ERROR(ApplyFrame(frame, state));
  const auto start = Clock::now();
  LIMBER_RETURN_IF_ERROR(state->Solve(options, &result.report));
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

Json FrameJson(const std::string& positions, const FrameResult& result, const PoseState& state) {
  const std::span<const double> weights = state.blend_weights();
  const auto num_shapes = static_cast<size_t>(state.rig().num_shapes());
  Json groups = Json::array();
  for (size_t g = 0; g * num_shapes < weights.size(); ++g) {
    const auto row = weights.subspan(g * num_shapes, num_shapes);
    groups.push_back(Json(Vector<double>(row.begin(), row.end())));
  }
  return {{"positions", positions},
          {"blend_weights", groups},
          {"energy", result.report.energy},
          {"iterations", result.report.iterations},
          {"settled", result.report.settled},
          {"change", result.report.change},
          {"optimality", result.report.optimality},
          {"seconds", result.seconds}};
}

struct Solved {
  Json frames = Json::array();
  double seconds = 0, slowest = 0;
};

Result<Solved> SolveFrames(const PoseRun& run, const PoseRunOptions& options,
                           const bake::SourceFaces& faces, OutputFolder* output,
                           ProgressBar* progress) {
  Result<PoseState> state = CreateState(run.rig, options);
  if (!state.ok()) return state.status();
  Result<CpuSkinner> skinner = CpuSkinner::Create(run.rig->mesh(), run.rig->tables().space);
  if (!skinner.ok()) return skinner.status();
  Solved solved;
  for (size_t i = 0; i < run.frames.size(); ++i) {
    if (!progress->Update("solve", double(i) / double(run.frames.size()))) {
      return Error(StatusCode::kInvalidArgument, "interrupted");
    }
    const auto frame = SolveFrame(run.frames[i], options.ForSolver(*run.rig), &*state);
    if (!frame.ok()) return frame.status().WithContext("frame " + std::to_string(i));
    LIMBER_RETURN_IF_ERROR(skinner->SkinPositionsOnly(state->transforms()));
    const std::string name = FrameName(i) + ".obj";
    LIMBER_RETURN_IF_ERROR(
        output->Write(name, ObjText(run.rig->mesh(), faces, skinner->result().solve_positions)));
    solved.frames.push_back(FrameJson(name, *frame, *state));
    solved.seconds += frame->seconds;
    solved.slowest = std::max(solved.slowest, frame->seconds);
  }
  return solved;
}

Result<bake::SourceFaces> FacesOfRig(const GltfFile& file) {
  const int node = FindRigNode(file, 0);
  if (node < 0)
    return Error(StatusCode::kMalformed, "%s: no node has the rig", file.name().c_str());
  return bake::ReadSourceFaces(file,
                               file.json()["nodes"][static_cast<size_t>(node)]["mesh"].get<int>());
}

ExitCode RunSolve(const PoseRunOptions& options, const Console& console) {
  const Result<GltfFile> file = GltfFile::Open(options.baked);
  if (!file.ok()) return console.Fail(file.status());
  const Result<PoseRun> run = LoadPoseRun(*file, options);
  if (!run.ok()) return console.Fail(run.status());
  const Result<bake::SourceFaces> faces = FacesOfRig(*file);
  if (!faces.ok()) return console.Fail(faces.status());
  if (Status s = bake::CheckKeepsInputs(std::filesystem::path(options.output) / kReportName,
                                        std::array<std::filesystem::path, 1>{options.targets});
      !s.ok()) {
    return console.Fail(s);
  }
  Result<OutputFolder> output = OutputFolder::Create(options.output);
  if (!output.ok()) return console.Fail(output.status());
  ProgressBar progress(console);
  const Result<Solved> solved = SolveFrames(*run, options, *faces, &*output, &progress);
  progress.Clear();
  if (!solved.ok()) return console.Fail(solved.status());
  const Json report = {{"frames", solved->frames}};
  if (Status s = output->Write(kReportName, report.dump(1) + "\n"); !s.ok()) {
    return console.Fail(s);
  }
  if (Status s = output->Publish(); !s.ok()) return console.Fail(s);

  const size_t num_frames = run->frames.size();
  const double mean_ms = num_frames == 0 ? 0 : 1e3 * solved->seconds / double(num_frames);
  console.Print("solved %zu frames of %s: %.3f ms a frame, the slowest %.3f ms", num_frames,
                run->rig->name().c_str(), mean_ms, 1e3 * solved->slowest);
  console.Print("  %s/frame_0000.obj ..., %s/solve.json", output->path().c_str(),
                output->path().c_str());
  console.Emit({{"output", output->path().string()},
                {"report", (output->path() / kReportName).string()},
                {"frames", num_frames},
                {"solve_ms_mean", mean_ms},
                {"solve_ms_max", 1e3 * solved->slowest}});
  return kSuccess;
}

}  // namespace

Command AddSolveCommand(CLI::App* parent) {
  CLI::App* app = parent->add_subcommand("solve", "Drag a baked character, write meshes (OBJ)");
  auto options = std::make_shared<PoseRunOptions>();
  options->AddTo(app);
  app->footer(kFooter);
  return {app, [options](const Console& console) { return RunSolve(*options, console); }};
}

}  // namespace limber::cli
