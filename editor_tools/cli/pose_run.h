// A baked character and the frames that drag it, checked against each other: what `solve` and
// `render` have in common.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "import/frames_file.h"
#include "load/gltf_file.h"
#include "rig/rig.h"
#include "solve/pose_solver.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>
#include <utility>

namespace limber::cli {

// The part of the command line that both commands share.
struct PoseRunOptions {
  std::string baked, targets, output;
  int iterations = 0;  // 0: not given
  float lambda = 0.5f;
  bool no_rotations = false;
  bool uniform = false, no_roots = false;
  bool settle = false;
  bool guaranteed = false;
  double stretch_limit = 0;         // 0: none
  double smoothing = 0, rate = 60;  // seconds of lag (0: none), frames a second

  void AddTo(CLI::App* app);
  // A rig baked without rotations is solved without them.
  PoseOptions ForSolver(const Rig& rig) const;
};

struct PoseFrame {
  Vector<std::pair<int, bake::HandleInput>> inputs;  // handle, what becomes of it
};

struct PoseRun {
  std::shared_ptr<const Rig> rig;
  Vector<PoseFrame> frames;
};

// Errors as of the loader and of the frames file; kInvalidArgument for a name that no handle has
// (with the names there are) and for the target of a handle that is not pinned then.
Result<PoseRun> LoadPoseRun(const GltfFile& baked, const PoseRunOptions& options);

// A state in which any handle can be given a rotation.
Result<PoseState> CreateState(const std::shared_ptr<const Rig>& rig, const PoseRunOptions& options);

// Sets what one frame says; handles it leaves out stay as they were.
Status ApplyFrame(const PoseFrame& frame, PoseState* state);

// "frame_0000" and so on.
std::string FrameName(size_t index);

}  // namespace limber::cli
