// The reduced AMRAP solve (Wampler 2016, section 5): handle targets in, blend weights and skinning
// transforms out. Letters in SYMBOLS.md.
//
// Three objects: the Rig (shared, immutable), a PoseModel (what follows from the rig and its pins;
// shared, immutable) and a PoseState (one per character). Any number of states may be solved at
// once on different threads; one state belongs to one thread at a time. Nothing allocates after
// PoseState::Create.
#pragma once

#include <memory>
#include <span>

#include "core/status.h"
#include "core/vec3.h"
#include "rig/rig.h"
#include "skin/skin_transforms.h"

namespace limber {

struct PoseOptions {
  int iterations = 1;         // alternations of eq. 20 (transforms, blend weights) and 22 (rotations)
  float lambda = 0.5f;        // weight of nearness in eq. 10; 0: shape space only
  bool rotations = true;      // false: all R = I, one convex solve, globally optimal
  // Stop before `iterations` when no vertex-scale quantity changed by more than this fraction of
  // the character's size in an alternation; 0: never.
  float settle_tolerance = 0;
};

struct PoseReport {
  double energy = 0;          // eq. 10, in mesh units
  int iterations = 0;         // alternations done
  double change = 0;          // largest change of a mode in the last alternation, of the size
  bool settled = false;       // change <= settle_tolerance
  double optimality = 0;      // largest violation of the convex step's optimality, of its scale
};

class PoseModel;   // see pose_model.h
class PoseStateImpl;

class PoseState {
 public:
  // The state at rest: targets at the handles' rest positions, settled on the first example shape.
  // Errors: kNoHandles; kUnsupported where options ask for rotations of a rig baked without.
  static Result<PoseState> Create(std::shared_ptr<const Rig> rig);
  PoseState(PoseState&&) noexcept;
  PoseState& operator=(PoseState&&) noexcept;
  ~PoseState();

  const Rig& rig() const;
  // Mesh space. Targets of free handles and non-finite positions are refused (kInvalidArgument) and
  // leave the old target.
  Status SetTarget(int handle, Vec3 position_mesh);
  Vec3 target(int handle) const;
  void ResetToRest();

  // Moves towards the optimum from where the last call ended. Costs microseconds to milliseconds,
  // independent of the vertex count.
  Status Solve(const PoseOptions& options, PoseReport* report);

  // Results of the last Solve (or of the rest pose): owned by the state, valid until the next call.
  SkinTransforms transforms() const;
  std::span<const double> blend_weights() const;   // B, [G][S]

 private:
  explicit PoseState(std::unique_ptr<PoseStateImpl> impl);
  std::unique_ptr<PoseStateImpl> impl_;
};

}  // namespace limber
