#include "viewer/play_character.h"

#include "core/vector.h"
#include "viewer/play_drag.h"

#include <algorithm>
#include <utility>

namespace limber::viewer {
namespace {

// Blend weights and rotations that change by less are not seen to move.
constexpr double kStill = 1e-5;

// How firmly fingers hold the skin (PoseState::SetStiffness).
constexpr float kGrabStiffness = 20;

}  // namespace

Result<PlayCharacter> PlayCharacter::Create(const std::shared_ptr<const Rig>& rig,
                                            const PoseOptions& options) {
  Result<CpuSkinner> skinner = CpuSkinner::Create(rig->mesh(), rig->tables().space);
  if (!skinner.ok()) return skinner.status();
  Result<PoseState> state = PoseState::Create(rig);
  if (!state.ok()) return state.status();
  LIMBER_RETURN_IF_ERROR(skinner->SkinPositionsOnly(state->transforms()));
  Result<Picker> picker = Picker::Create(rig->mesh(), skinner->result().solve_positions);
  if (!picker.ok()) return picker.status();
  PlayCharacter character(std::move(*state), std::move(*skinner), std::move(*picker));
  character.options_ = options;
  character.options_.rotations = options.rotations && rig->tables().has_rotations;
  const auto num_handles = static_cast<size_t>(rig->num_handles());
  character.handle_positions_.resize(num_handles);
  character.pinned_ = std::make_unique<bool[]>(num_handles);
  character.PlaceHandles();
  return character;
}

PlayCharacter::PlayCharacter(PoseState state, CpuSkinner skinner, Picker picker)
    : state_(std::move(state)),
      skinner_(std::move(skinner)),
      picker_(std::move(picker)) {}

void PlayCharacter::PlaceHandles() {
  const Vector<RigHandle>& handles = rig().tables().handles;
  for (size_t h = 0; h < handles.size(); ++h) {
    const uint32_t v = handles[h].vertex;
    pinned_[h] = state_.is_pinned(static_cast<int>(h));
    handle_positions_[h] =
        pinned_[h] ? state_.target(static_cast<int>(h)) : state_.Place({{v, v, v}, {1, 0, 0}});
  }
}

void PlayCharacter::MoveHandle(int handle, Vec3 target_mesh) {
  if (!state_.SetTarget(handle, target_mesh).ok()) return;
  handle_positions_[static_cast<size_t>(handle)] = target_mesh;
  moving_ = true;
}

void PlayCharacter::TogglePin(int handle) {
  const auto num_pinned = std::count(pinned_.get(), pinned_.get() + rig().num_handles(), true);
  if (pinned(handle) && num_pinned == 1) return;
  const Status status = pinned(handle) ? state_.Unpin(handle) : state_.Pin(handle);
  if (!status.ok()) return;
  moving_ = true;
  PlaceHandles();
}

bool PlayCharacter::GrabSkin(const SkinPoint& point) {
  ReleaseGrab();
  const Result<int> grab = state_.Grab(point, kGrabStiffness);
  if (!grab.ok()) return false;
  grab_ = *grab;
  moving_ = true;
  return true;
}

void PlayCharacter::MoveGrab(Vec3 target_mesh) {
  if (grab_ >= 0 && state_.SetGrabTarget(grab_, target_mesh).ok()) moving_ = true;
}

void PlayCharacter::ReleaseGrab() {
  if (grab_ < 0) return;
  (void)state_.Release(grab_);  // it is held
  grab_ = -1;
  moving_ = true;
}

void PlayCharacter::Reset() {
  state_.ResetToRest();
  grab_ = -1;
  moving_ = true;
  PlaceHandles();
}

Status PlayCharacter::Step() {
  PoseReport report;
  LIMBER_RETURN_IF_ERROR(state_.Solve(options_, &report));
  moving_ = report.change > kStill;
  skinned_ = pickable_ = false;
  PlaceHandles();
  return {};
}

Result<std::span<const Vec3>> PlayCharacter::SolvePositions() {
  if (!skinned_) LIMBER_RETURN_IF_ERROR(skinner_.SkinPositionsOnly(transforms()));
  skinned_ = true;
  return skinner_.result().solve_positions;
}

Status PlayCharacter::EnsurePickable() {
  if (pickable_) return {};
  const Result<std::span<const Vec3>> positions = SolvePositions();
  if (!positions.ok()) return positions.status();
  // A pose that cannot be picked (targets thrown to the end of the number range) can still be
  // reset or dragged back: picks see the last good surface until then.
  Status updated = picker_.Update(*positions);
  if (!updated.ok() && updated.code() != StatusCode::kInvalidArgument) return updated;
  pickable_ = true;
  return {};
}

Result<PointerHit> PlayCharacter::Pick(const PickRay& ray, const HandlePickOptions& reach,
                                       bool dots_shown) {
  LIMBER_RETURN_IF_ERROR(EnsurePickable());
  PointerHit hit;
  if (dots_shown) {
    if (const auto dot = picker_.PickHandle(ray, handle_positions_, reach)) {
      hit.target = PointerTarget::kHandle;
      hit.handle = dot->handle;
      hit.point = handle_positions_[static_cast<size_t>(dot->handle)];
      return hit;
    }
  }
  if (const auto surface = picker_.PickSurface(ray)) {
    hit.target = PointerTarget::kSkin;
    hit.point = surface->point;
    hit.skin = {surface->solve_vertices, surface->barycentrics};
    hit.handle = NearestPoint(surface->point, handle_positions_, pinned_handles());
  }
  return hit;
}

}  // namespace limber::viewer
