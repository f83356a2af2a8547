#include "solve/pose_solver.h"

#include "core/out_of_memory.h"
#include "core/vector.h"
#include "solve/pose_state_impl.h"

namespace limber {
namespace {

constexpr int kMostExtraHolds = 1000;  // of each kind: more is a mistake

Status CheckRoom(const PoseModel& model, const PoseRoom& room) {
  if (room.grabs >= 0 && room.grabs <= kMostExtraHolds && room.rotations >= 0 &&
      room.rotations <= kMostExtraHolds) {
    return {};
  }
  return Error(StatusCode::kInvalidArgument,
               "%s: room for %d grabs and %d rotations; expected 0 to %d of each",
               model.rig->name().c_str(), room.grabs, room.rotations, kMostExtraHolds);
}

}  // namespace

PoseState::PoseState(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

PoseState::PoseState(PoseState&&) noexcept = default;
PoseState& PoseState::operator=(PoseState&&) noexcept = default;
PoseState::~PoseState() = default;

Result<PoseState> PoseState::Create(std::shared_ptr<const PoseModel> model, PoseRoom room) {
  if (model == nullptr) return Error(StatusCode::kInvalidArgument, "no pose model was given");
  LIMBER_RETURN_IF_ERROR(CheckRoom(*model, room));
  return CatchOutOfMemory(model->rig->name(), [&]() -> Result<PoseState> {
    return PoseState(std::make_unique<Impl>(model, room, nullptr));
  });
}

Result<PoseState> PoseState::Create(std::shared_ptr<PoseWorkspaces> workspaces, PoseRoom room) {
  if (workspaces == nullptr)
    return Error(StatusCode::kInvalidArgument, "no pose workspaces were given");
  std::shared_ptr<const PoseModel> model = workspaces->model();
  LIMBER_RETURN_IF_ERROR(CheckRoom(*model, room));
  if (!workspaces->HasRoomFor(room)) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: the workspaces have no room for %d grabs and %d rotations%s",
                 model->rig->name().c_str(), room.grabs, room.rotations,
                 room.guaranteed ? ", nor ever for the guaranteed mode" : "");
  }
  return CatchOutOfMemory(model->rig->name(), [&]() -> Result<PoseState> {
    return PoseState(std::make_unique<Impl>(model, room, std::move(workspaces)));
  });
}

Result<PoseState> PoseState::Create(std::shared_ptr<const Rig> rig, PoseRoom room) {
  Result<std::shared_ptr<const PoseModel>> model = PoseModel::Create(std::move(rig));
  if (!model.ok()) return model.status();
  return Create(std::move(model).value(), room);
}

const Rig& PoseState::rig() const {
  return *impl_->model->rig;
}

Status PoseState::SetTarget(int handle, Vec3 position_mesh) {
  return impl_->held.SetTarget(rig(), handle, position_mesh);
}

Vec3 PoseState::target(int handle) const {
  return impl_->held.target(handle);
}

Status PoseState::Pin(int handle) {
  const Vector<RigHandle>& handles = rig().tables().handles;
  const bool known = handle >= 0 && handle < rig().num_handles();
  const uint32_t vertex = known ? handles[static_cast<size_t>(handle)].vertex : 0;
  return impl_->held.Pin(rig(), handle, impl_->Place({{vertex, vertex, vertex}, {1, 0, 0}}));
}

Status PoseState::Unpin(int handle) {
  return impl_->held.Unpin(rig(), handle);
}

bool PoseState::is_pinned(int handle) const {
  return impl_->held.is_pinned(handle);
}

Status PoseState::SetStiffness(int handle, float stiffness) {
  return impl_->held.SetStiffness(rig(), handle, stiffness);
}

Status PoseState::SetWeight(int handle, float weight) {
  return impl_->held.SetWeight(rig(), handle, weight);
}

Status PoseState::SetRotation(int handle, Quaternion rotation, float stiffness) {
  return impl_->held.SetRotation(rig(), handle, rotation, stiffness);
}

Status PoseState::ClearRotation(int handle) {
  return impl_->held.ClearRotation(rig(), handle);
}

Result<int> PoseState::Grab(const SkinPoint& point, float stiffness) {
  LIMBER_RETURN_IF_ERROR(CheckSkinPoint(rig(), point));
  return impl_->held.Grab(rig(), point, impl_->Place(point), stiffness);
}

Status PoseState::SetGrabTarget(int grab, Vec3 position_mesh) {
  return impl_->held.SetGrabTarget(rig(), grab, position_mesh);
}

Status PoseState::Release(int grab) {
  return impl_->held.Release(rig(), grab);
}

Vec3 PoseState::Place(const SkinPoint& point) const {
  return CheckSkinPoint(rig(), point).ok() ? impl_->Place(point) : Vec3{};
}

void PoseState::ResetToRest() {
  impl_->ResetToRest();
}

Status PoseState::Solve(const PoseOptions& options, PoseReport* report) {
  return impl_->Solve(options, report);
}

SkinTransforms PoseState::transforms() const {
  const RigSpace& space = impl_->model->rig->tables().space;
  return {impl_->matrices, Vec3{space.origin[0], space.origin[1], space.origin[2]}};
}

std::span<const double> PoseState::blend_weights() const {
  return {impl_->blend().data(), static_cast<size_t>(impl_->model->num_blocks)};
}

}  // namespace limber
