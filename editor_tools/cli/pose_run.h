// A baked character and the frames that drag it, checked against each other: what `solve` and
// `render` have in common.
#pragma once

#include "core/status.h"
#include "core/vec3.h"
#include "load/gltf_file.h"
#include "rig/rig.h"
#include "solve/pose_solver.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace limber::cli {

// The part of the command line that both commands share.
struct PoseRunOptions {
  std::string baked, targets, output;
  int iterations = 0;  // 0: not given
  float lambda = 0.5f;
  bool no_rotations = false;
  bool uniform = false, no_roots = false;
  bool settle = false;

  void AddTo(CLI::App* app);
  // A rig baked without rotations is solved without them.
  PoseOptions ForSolver(const Rig& rig) const;
};

struct PoseFrame {
  std::vector<std::pair<int, Vec3>> targets;  // handle, position in mesh space
};

struct PoseRun {
  std::shared_ptr<const Rig> rig;
  std::vector<PoseFrame> frames;
};

// Errors as of the loader and of the frames file; kInvalidArgument for a name that no handle has
// (with the names there are) and for a free handle.
Result<PoseRun> LoadPoseRun(const GltfFile& baked, const PoseRunOptions& options);

// Sets the targets of one frame; handles it leaves out keep theirs.
Status ApplyFrame(const PoseFrame& frame, PoseState* state);

// "frame_0000" and so on.
std::string FrameName(size_t index);

}  // namespace limber::cli
