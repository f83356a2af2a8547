// The character in play, without window or device: targets in, pose out, and what a ray hits.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "pick/picker.h"
#include "rig/rig.h"
#include "skin/cpu_skinner.h"
#include "solve/pose_solver.h"
#include "viewer/play_input.h"

#include <memory>
#include <span>

namespace limber::viewer {

// What the pointer is over.
struct PointerHit {
  PointerTarget target = PointerTarget::kBackground;
  int handle = -1;  // the dot; on the skin the nearest pinned handle
  Vec3 point;       // the dot's middle, or the point of the skin
  SkinPoint skin;   // that point, where the target is the skin
};

class PlayCharacter {
 public:
  static Result<PlayCharacter> Create(const std::shared_ptr<const Rig>& rig,
                                      const PoseOptions& options);

  const Rig& rig() const { return state_.rig(); }

  bool planar() const { return rig().dimension() == 2; }

  // Where the dots are: a pinned handle's target, another handle's place on the skin. Mesh space.
  std::span<const Vec3> handle_positions() const { return handle_positions_; }

  bool pinned(int handle) const { return pinned_[static_cast<size_t>(handle)]; }

  // One pinned handle after another, as spans need them (never vector<bool>).
  std::span<const bool> pinned_handles() const {
    return {pinned_.get(), static_cast<size_t>(rig().num_handles())};
  }

  // Moves a pinned handle's target; refused positions and free handles change nothing.
  void MoveHandle(int handle, Vec3 target_mesh);
  // Pins a handle where it is, or lets it go; the last one that is pinned stays.
  void TogglePin(int handle);

  // Takes hold of the skin, as with fingers: it follows, but is not torn off. False where the rig
  // does not allow it (baked in format version 1). One point at a time.
  bool GrabSkin(const SkinPoint& point);
  void MoveGrab(Vec3 target_mesh);
  void ReleaseGrab();

  void Reset();

  // One solve with warm start. The pose is `moving()` until a solve changes nothing any more.
  Status Step();

  bool moving() const { return moving_; }

  SkinTransforms transforms() const { return state_.transforms(); }

  // The deformed solve vertices, mesh space; valid until the next call. Skinned when first asked
  // for after a Step.
  Result<std::span<const Vec3>> SolvePositions();

  // What lies under the ray. Dots come before the skin, and where `dots_shown` is false they are
  // not there. Refits the picking structure if the pose has changed.
  Result<PointerHit> Pick(const PickRay& ray, const HandlePickOptions& reach, bool dots_shown);

 private:
  PlayCharacter(PoseState state, CpuSkinner skinner, Picker picker);
  void PlaceHandles();
  Status EnsurePickable();

  PoseState state_;
  CpuSkinner skinner_;
  Picker picker_;
  PoseOptions options_;
  Vector<Vec3> handle_positions_;
  std::unique_ptr<bool[]> pinned_;
  int grab_ = -1;
  bool moving_ = true;
  bool skinned_ = false, pickable_ = false;  // up to date with the last Step
};

}  // namespace limber::viewer
