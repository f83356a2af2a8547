// The reduced AMRAP solve (Wampler 2016, section 5): handle targets in, blend weights and skinning
// transforms out. Letters in SYMBOLS.md.
//
// Three objects: the Rig (shared, immutable), a PoseModel (what follows from the rig and its pins;
// shared, immutable) and a PoseState (one per character). Any number of states may be solved at
// once on different threads; one state belongs to one thread at a time. Nothing allocates, locks
// or throws after PoseState::Create.
#pragma once

#include "core/status.h"
#include "core/vec3.h"
#include "rig/rig.h"
#include "skin/skin_transforms.h"
#include "solve/stage_times.h"

#include <memory>
#include <span>

namespace limber {

class PoseModel;  // pose_model.h

struct PoseOptions {
  int iterations = 1;     // alternations of eq. 20 (transforms, blend weights) and 22 (rotations)
  float lambda = 0.5f;    // weight of nearness in eq. 10; 0: shape space only
  bool rotations = true;  // false: all R = I, one convex solve, globally optimal
  // false: E_d + lambda sum B D in place of eq. 10's roots; softer transitions between shapes, and
  // a plain quadratic program.
  bool square_roots = true;
  bool varying_blend = true;  // false: the same blend weights in all edge groups
  // Stop before `iterations` once an alternation's change (below) is at most this; 0: never.
  double settle_tolerance = 0;
  bool measure_stages = false;  // fill PoseReport::stages; the results are the same
};

struct PoseReport {
  double energy = 0;      // eq. 10, in mesh units (of the cotangent-weighted edges); without roots
                          // its square's units
  double elastic = 0;     // the square root of E_d (eq. 9)
  int iterations = 0;     // alternations done
  double change = 0;      // largest change of a blend weight or of a rotation in use
  bool settled = false;   // a tolerance was given and change <= settle_tolerance
  double optimality = 0;  // largest violated multiplier of the convex step, of its largest gradient
  bool optimal = true;    // the convex step reached its optimum (optimality is zero)
  int used_weights = 0;   // blend weights that the convex step worked with, of G*S
  StageTimes stages;      // where measure_stages asks for it, else zero
};

class PoseState {
 public:
  // The state at rest: targets at the handles' rest positions, settled on the first example shape.
  // The second form builds a PoseModel for itself; characters of one rig should share one. Errors:
  // kInvalidArgument (null), those of PoseModel::Create, kOutOfMemory.
  static Result<PoseState> Create(std::shared_ptr<const PoseModel> model);
  static Result<PoseState> Create(std::shared_ptr<const Rig> rig);
  PoseState(PoseState&&) noexcept;
  PoseState& operator=(PoseState&&) noexcept;
  ~PoseState();

  const Rig& rig() const;
  // Mesh space. Refused with kInvalidArgument, keeping the old target: an index out of range, a
  // free handle (it has no target), a position that is not finite or further than a million times
  // the character's size from it (single precision would not carry the result).
  Status SetTarget(int handle, Vec3 position_mesh);
  // Of a free handle: its rest position. Of an index out of range: the origin.
  Vec3 target(int handle) const;
  void ResetToRest();

  // Moves towards the optimum from where the last call ended. Costs microseconds to milliseconds,
  // independent of the vertex count. report may be null. Errors, the state being unchanged:
  // kInvalidArgument (options out of range), kUnsupported (rotations of a rig baked without).
  Status Solve(const PoseOptions& options, PoseReport* report);

  // Results of the last Solve, or of the rest pose: owned by the state, valid until its next call.
  SkinTransforms transforms() const;
  std::span<const double> blend_weights() const;  // B, [G][S]

  class Impl;

 private:
  explicit PoseState(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
