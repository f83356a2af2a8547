#include "viewer/play_character.h"

#include "viewer/play_drag.h"

#include <utility>

namespace limber::viewer {
namespace {

// Blend weights and rotations that change by less are not seen to move.
constexpr double kStill = 1e-5;

// Eq. 6 for one solve vertex.
Vec3 SkinVertex(const SkinMesh& mesh, const SkinTransforms& transforms, uint32_t vertex) {
  const auto handles = static_cast<size_t>(mesh.num_handles);
  const auto shapes = static_cast<size_t>(mesh.num_shapes);
  double sum[3] = {};
  for (size_t h = 0; h < handles; ++h) {
    const double weight = mesh.weights[vertex * handles + h];
    for (size_t s = 0; s < shapes; ++s) {
      const Vec3 p = mesh.shape_positions[s * mesh.num_solve_vertices + vertex];
      const float* m = &transforms.matrices[(h * shapes + s) * 12];
      for (size_t row = 0; row < 3; ++row) {
        const float* r = m + 4 * row;
        sum[row] += weight * (double{r[0]} * p.x + double{r[1]} * p.y + double{r[2]} * p.z + r[3]);
      }
    }
  }
  const Vec3 o = transforms.origin;
  return {static_cast<float>(o.x + sum[0]), static_cast<float>(o.y + sum[1]),
          static_cast<float>(o.z + sum[2])};
}

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
  for (size_t h = 0; h < num_handles; ++h) {
    character.pinned_[h] = rig->tables().handles[h].pinned;
  }
  character.PlaceHandles();
  return character;
}

PlayCharacter::PlayCharacter(PoseState state, CpuSkinner skinner, Picker picker)
    : state_(std::move(state)),
      skinner_(std::move(skinner)),
      picker_(std::move(picker)) {}

void PlayCharacter::PlaceHandles() {
  const std::vector<RigHandle>& handles = rig().tables().handles;
  for (size_t h = 0; h < handles.size(); ++h) {
    handle_positions_[h] = handles[h].pinned
                               ? state_.target(static_cast<int>(h))
                               : SkinVertex(rig().mesh(), transforms(), handles[h].vertex);
  }
}

void PlayCharacter::MoveHandle(int handle, Vec3 target_mesh) {
  if (!state_.SetTarget(handle, target_mesh).ok()) return;
  handle_positions_[static_cast<size_t>(handle)] = target_mesh;
  moving_ = true;
}

void PlayCharacter::Reset() {
  state_.ResetToRest();
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
    hit.handle = NearestPoint(surface->point, handle_positions_, pinned_handles());
  }
  return hit;
}

}  // namespace limber::viewer
