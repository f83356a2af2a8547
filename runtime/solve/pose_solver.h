// The reduced AMRAP solve (Wampler 2016, section 5): handle targets in, blend weights and skinning
// transforms out. Letters in SYMBOLS.md.
//
// Three objects: the Rig (shared, immutable), a PoseModel (what follows from the rig and its pins;
// shared, immutable) and a PoseState (one per character). Any number of states may be solved at
// once on different threads; one state belongs to one thread at a time. Nothing allocates, locks
// or throws after PoseState::Create.
#pragma once

#include "core/quaternion.h"
#include "core/status.h"
#include "core/vec3.h"
#include "rig/rig.h"
#include "rig/skin_point.h"
#include "skin/skin_transforms.h"
#include "solve/stage_times.h"

#include <limits>
#include <memory>
#include <span>

namespace limber {

class PoseModel;       // pose_model.h
class PoseWorkspaces;  // pose_workspaces.h

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
  // The guaranteed mode (the paper's appendix A, trust_region.h): with rotations the plain
  // alternation may increase the energy or never rest; this one, while targets stay, never
  // increases it and rests only where nothing decreases it. Some three times the cost. Needs
  // PoseRoom::guaranteed; points held exactly only, no smoothing.
  bool guaranteed = false;
  // No two pinned handles are further apart than this times the longest path over the skin between
  // them in any example: targets that ask for more give way (stretch_limit.h), each by its weight
  // (SetWeight). 0: no limit; 1: a straight limb is as long as it gets.
  double stretch_limit = 0;
  // Above 0: what is shown follows the solution smoothly in time (motion_smoother.h), with two
  // continuous derivatives where the solution is continuous, whatever the frame rate; held points
  // still meet their targets, and at rest it is the solution exactly. Seconds of lag (0.05 is
  // brisk), and seconds since the last call. For the same motion at any frame rate let each call
  // settle, too.
  double smoothing = 0, time_step = 0;
  // Seconds after which no further alternation is begun; the first is always done. 0: no limit.
  // With one, results depend on how fast the machine is at the moment.
  double time_budget = 0;
  bool measure_stages = false;  // fill PoseReport::stages; the results are the same
};

struct PoseReport {
  double energy = 0;   // eq. 10, in mesh units (of the cotangent-weighted edges); without roots
                       // its square's units
  double elastic = 0;  // the square root of E_d (eq. 9)
  int iterations = 0;  // alternations done
  double change = 0;   // largest change of a blend weight or of a rotation in use
  // A tolerance was given and change <= settle_tolerance; in the guaranteed mode also where nothing
  // decreases the energy any more.
  bool settled = false;
  bool out_of_time = false;  // the time budget ended it: neither settled nor all iterations done
  double optimality = 0;  // largest violated multiplier of the convex step, of its largest gradient
  bool optimal = true;    // the convex step reached its optimum (optimality is zero)
  int rejected = 0;       // guaranteed mode: steps that were tried in vain
  int pairs_at_limit = 0;     // pairs of handles that the stretch limit holds back
  double excess_stretch = 0;  // left where handles that do not give way are too far apart
  bool at_rest = true;        // false: smoothing, and what is shown is still on its way
  int used_weights = 0;       // blend weights that the convex step worked with, of G*S
  StageTimes stages;          // where measure_stages asks for it, else zero
};

// Room that a state is created with: how many points of the skin may be grabbed at once, how many
// handles may have a target rotation, and whether for the guaranteed mode. Each row of room (one
// for a grab, k for a rotation) takes some 8 (n + 3 G S k) bytes.
struct PoseRoom {
  int grabs = 4;
  int rotations = 4;
  bool guaranteed = false;
};

// A stiffness that holds exactly.
inline constexpr float kHeldExactly = std::numeric_limits<float>::infinity();

class PoseState {
 public:
  // The state at rest: targets at the handles' rest positions, settled on the first example shape.
  // The second form builds a PoseModel for itself; characters of one rig should share one. Errors:
  // kInvalidArgument (null, room out of range), those of PoseModel::Create, kOutOfMemory.
  static Result<PoseState> Create(std::shared_ptr<const PoseModel> model, PoseRoom room = {});
  static Result<PoseState> Create(std::shared_ptr<const Rig> rig, PoseRoom room = {});
  // For crowds: a state that keeps only what it has to (for nine handles and six shapes 40 kB in
  // place of 1 MB) and borrows the rest for each call. Calls allocate where there is something to
  // make: a Solve as often as more states are solved at once than ever before, or the first time
  // that this one smooths or limits stretch; the first call that changes what is held. They say
  // kOutOfMemory then. Results are those of a state of its own, to the bit with rotations, to
  // rounding without. Errors: kInvalidArgument also where the workspaces have less room.
  static Result<PoseState> Create(std::shared_ptr<PoseWorkspaces> workspaces, PoseRoom room = {});
  PoseState(PoseState&&) noexcept;
  PoseState& operator=(PoseState&&) noexcept;
  ~PoseState();

  const Rig& rig() const;
  // Mesh space. Refused with kInvalidArgument, keeping the old target: an index out of range, a
  // handle that is not pinned (it has no target), a position that is not finite or further than a
  // million times the character's size from it (single precision would not carry the result).
  Status SetTarget(int handle, Vec3 position_mesh);
  // Of a handle that is not pinned: its last target, at first its rest position. Of an index out of
  // range: the origin.
  Vec3 target(int handle) const;
  // Targets at rest; pinned, exactly, are the handles that were baked so; no rotation, no grab.
  void ResetToRest();

  // What is held. A handle is held where it was baked as pinned; while the game runs any handle can
  // be pinned, where it is at the moment, and let go. Each call that changes what is held (not:
  // that moves it) costs the next Solve some tens of microseconds for a few handles and shapes
  // (O(c^3 S + G S k c^2) for c held rows); targets alone cost nothing. With nothing held at all
  // Solve says so. Errors, nothing being changed: kInvalidArgument (an index out of range, numbers
  // that are none).
  Status Pin(int handle);
  Status Unpin(int handle);
  bool is_pinned(int handle) const;

  // How firmly a pinned handle follows its target. A finite stiffness adds
  // 1/2 stiffness |x - target|^2 to E_d (eq. 9; all lengths in rig units), so that a target out of
  // reach pulls the character without tearing it: 1 pulls like a square patch of the skin that is
  // stretched along its side, 100 is nearly exact. 1e-6 to 1e9, or kHeldExactly.
  Status SetStiffness(int handle, float stiffness);

  // How little a handle's target gives way to PoseOptions::stretch_limit, beside the others' (1 at
  // first): 1e-6 to 1e9, or infinity not at all.
  Status SetWeight(int handle, float weight);

  // Turns the patch of skin that follows the handle most, against the first example, to this
  // rotation (mesh space; any length but zero; in the plane only the part about its normal counts).
  // Only the orientation is asked for: examples that stretch or bend the patch stay free to. The
  // position is held or not as before. Stiffness as above, of points a tenth of the character's
  // size from the handle. Later rotations of the same handle cost nothing extra. Further errors:
  // kLimitExceeded (no room), kUnsupported (a rig baked in format version 1).
  Status SetRotation(int handle, Quaternion rotation, float stiffness = kHeldExactly);
  Status ClearRotation(int handle);

  // Holds any point of the skin, from where it is at the moment. The id is for the calls below and
  // is never another grab's until a million later; errors as of SetRotation.
  Result<int> Grab(const SkinPoint& point, float stiffness = kHeldExactly);
  Status SetGrabTarget(int grab, Vec3 position_mesh);
  Status Release(int grab);

  // Where a point of the skin is after the last Solve, mesh space; the origin for a point that is
  // none. (Eq. 6 from transforms(): as skinning sees it.)
  Vec3 Place(const SkinPoint& point) const;

  // Moves towards the optimum from where the last call ended. Costs microseconds to milliseconds,
  // independent of the vertex count. report may be null. Errors, the state being unchanged:
  // kInvalidArgument (options out of range), kUnsupported (rotations of a rig baked without).
  Status Solve(const PoseOptions& options, PoseReport* report);

  // Results of the last Solve (smoothed, where that was asked for), or of the rest pose: owned by
  // the state, valid until its next call.
  SkinTransforms transforms() const;
  std::span<const double> blend_weights() const;  // B, [G][S]

  class Impl;

 private:
  explicit PoseState(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
