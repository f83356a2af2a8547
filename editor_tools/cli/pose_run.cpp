#include "cli/pose_run.h"

#include "core/vector.h"
#include "load/rig_loader.h"

#include <algorithm>
#include <cstdio>

namespace limber::cli {
namespace {

constexpr int kDefaultIterations = 1;
constexpr int kSettleIterations = 200;
constexpr float kSettleTolerance = 1e-6f;

std::string KnownHandles(const Rig& rig) {
  std::string names;
  for (const RigHandle& handle : rig.tables().handles) {
    if (!handle.pinned) continue;
    names += (names.empty() ? "" : ", ") + handle.name;
  }
  return names;
}

// `place` names the frame, for messages; pinned: which handles are at the moment, kept up to date.
Result<int> ResolveHandle(const Rig& rig, const bake::HandleInput& input, const std::string& place,
                          Vector<uint8_t>* pinned) {
  const std::string& name = input.handle;
  const int handle = rig.FindHandle(name);
  if (handle < 0) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: the character has no handle \"%s\"; its handles are %s", place.c_str(),
                 name.c_str(), KnownHandles(rig).c_str());
  }
  uint8_t& is_pinned = (*pinned)[static_cast<size_t>(handle)];
  if (input.pinned.has_value()) is_pinned = *input.pinned ? 1 : 0;
  if (input.target.has_value() && is_pinned == 0) {
    return Error(
        StatusCode::kInvalidArgument,
        "%s: handle \"%s\" is free and follows by itself; pin it (\"pinned\"), or drag one "
        "of those baked as pinned: %s",
        place.c_str(), name.c_str(), KnownHandles(rig).c_str());
  }
  return handle;
}

}  // namespace

void PoseRunOptions::AddTo(CLI::App* app) {
  app->add_option("BAKED", baked, "A glTF written by limber bake")->required()->option_text(" ");
  app->add_option("--targets", targets, "The frames, as JSON (see below)")
      ->required()
      ->option_text("FILE (required)");
  app->add_option("-o,--output", output, "Folder for the results; made if absent")
      ->required()
      ->option_text("DIR (required)");
  app->add_option("--iterations", iterations,
                  "Alternations of the solver a frame (default 1; with --settle at most 200)")
      ->check(CLI::Range(1, 100000))
      ->option_text("N");
  app->add_option("--lambda", lambda,
                  "Weight of nearness to the examples (default 0.5); 0: their span only")
      ->check(CLI::Range(0.0f, 1e6f))
      ->option_text("X");
  app->add_flag("--no-rotations", no_rotations,
                "Blend without local rotations: one convex problem, for faces and the like");
  app->add_flag("--uniform", uniform,
                "One blend for the whole character: no limb draws from an example of its own");
  app->add_flag("--no-roots", no_roots,
                "Energies in place of their square roots: softer transitions between examples");
  app->add_flag("--settle", settle, "Go on in each frame until nothing moves any more");
  app->add_flag("--guaranteed", guaranteed,
                "The mode whose energy never increases while targets stay (slower)");
  app->add_option("--stretch-limit", stretch_limit,
                  "Keep handles within X times the longest way between them over the skin in any "
                  "example (default: no limit)")
      ->check(CLI::Range(0.01, 1e6))
      ->option_text("X");
  app->add_option("--smoothing", smoothing,
                  "Let the character follow smoothly, with a lag of so many seconds (default 0)")
      ->check(CLI::Range(0.0, 1e3))
      ->option_text("S");
  app->add_option("--rate", rate, "Frames a second, for --smoothing (default 60)")
      ->check(CLI::Range(1e-3, 1e6))
      ->option_text("HZ");
}

PoseOptions PoseRunOptions::ForSolver(const Rig& rig) const {
  PoseOptions pose;
  pose.iterations = iterations > 0 ? iterations : settle ? kSettleIterations : kDefaultIterations;
  pose.lambda = lambda;
  pose.rotations = !no_rotations && rig.tables().has_rotations;
  pose.varying_blend = !uniform;
  pose.square_roots = !no_roots;
  pose.settle_tolerance = settle ? kSettleTolerance : 0;
  pose.guaranteed = guaranteed;
  pose.stretch_limit = stretch_limit;
  pose.smoothing = smoothing;
  pose.time_step = 1 / rate;
  return pose;
}

Result<PoseRun> LoadPoseRun(const GltfFile& baked, const PoseRunOptions& options) {
  auto rig = LoadRig(baked);
  if (!rig.ok()) return rig.status();
  const auto frames = bake::ReadFramesFile(options.targets);
  if (!frames.ok()) return frames.status();
  PoseRun run;
  run.rig = std::move(*rig);
  Vector<uint8_t> pinned;
  for (const RigHandle& handle : run.rig->tables().handles)
    pinned.push_back(handle.pinned ? 1 : 0);
  for (size_t i = 0; i < frames->size(); ++i) {
    const std::string place = options.targets + ": frames[" + std::to_string(i) + "]";
    PoseFrame frame;
    for (const bake::HandleInput& input : (*frames)[i]) {
      const Result<int> handle = ResolveHandle(*run.rig, input, place, &pinned);
      if (!handle.ok()) return handle.status();
      frame.inputs.emplace_back(*handle, input);
    }
    run.frames.push_back(std::move(frame));
  }
  return run;
}

Result<PoseState> CreateState(const std::shared_ptr<const Rig>& rig,
                              const PoseRunOptions& options) {
  PoseRoom room;
  room.rotations = std::min(rig->num_handles(), 1000);
  room.guaranteed = options.guaranteed;
  return PoseState::Create(rig, room);
}

Status ApplyFrame(const PoseFrame& frame, PoseState* state) {
  for (const auto& [handle, input] : frame.inputs) {
    if (input.pinned.has_value())
      LIMBER_RETURN_IF_ERROR(*input.pinned ? state->Pin(handle) : state->Unpin(handle));
    if (input.stiffness.has_value())
      LIMBER_RETURN_IF_ERROR(state->SetStiffness(handle, *input.stiffness));
    if (input.weight.has_value()) LIMBER_RETURN_IF_ERROR(state->SetWeight(handle, *input.weight));
    if (input.target.has_value()) LIMBER_RETURN_IF_ERROR(state->SetTarget(handle, *input.target));
    if (input.rotation.has_value())
      LIMBER_RETURN_IF_ERROR(state->SetRotation(handle, *input.rotation));
    if (input.clears_rotation) LIMBER_RETURN_IF_ERROR(state->ClearRotation(handle));
  }
  return {};
}

std::string FrameName(size_t index) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04zu", index);
  return name;
}

}  // namespace limber::cli
