// limber.h: another rig under an instance that lives on.
#include "capi/context.h"
#include "capi/instance_calls.h"

namespace limber::capi {
namespace {

constexpr int32_t kSettleIterations = 100;
constexpr double kSettleTolerance = 1e-6;

// What was asked of one handle, asked of another. A wish that the new rig cannot grant (a target
// out of its reach, rotations of an old bake) is left out: its own setting stands.
void TakeOver(const Instance& old, int32_t old_handle, int32_t handle, Instance* instance) {
  PoseState& state = instance->state;
  const HandleWishes& wishes = old.wishes[static_cast<size_t>(old_handle)];
  HandleWishes& taken = instance->wishes[static_cast<size_t>(handle)];
  const bool pinned = old.state.is_pinned(old_handle);
  if (pinned != state.is_pinned(handle)) (void)(pinned ? state.Pin(handle) : state.Unpin(handle));
  if (pinned) (void)state.SetTarget(handle, old.state.target(old_handle));
  if (wishes.stiffness != taken.stiffness && state.SetStiffness(handle, wishes.stiffness).ok())
    taken.stiffness = wishes.stiffness;
  if (wishes.weight != taken.weight && state.SetWeight(handle, wishes.weight).ok())
    taken.weight = wishes.weight;
  if (wishes.is_turned &&
      state.SetRotation(handle, wishes.rotation, wishes.rotation_stiffness).ok()) {
    taken.is_turned = true;
    taken.rotation = wishes.rotation;
    taken.rotation_stiffness = wishes.rotation_stiffness;
  }
}

// The pose of what is asked for now, by the options of the old one's last solve; those that the new
// rig does not grant are for the next solve to refuse.
void Settle(const LimberSolveDef& last, Instance* instance) {
  LimberSolveDef def = last;
  def.iterations = kSettleIterations;
  def.settle_tolerance = kSettleTolerance;
  def.smoothing = def.time_step = def.time_budget = 0;
  (void)SolveInstance(def, instance, nullptr);
  instance->last_solve = last;
}

CallStatus Switch(RigEntry* entry, Instance* instance) {
  std::unique_ptr<Instance> next;
  LimberInstanceDef def = instance->def;
  def.record = 0;
  LIMBER_RETURN_IF_FAILED(MakeInstance(def, entry, &next));
  const Rig& old = instance->state.rig();
  for (int32_t handle = 0; handle < old.num_handles(); ++handle) {
    const int32_t of_name =
        entry->rig->FindHandle(old.tables().handles[static_cast<size_t>(handle)].name);
    if (of_name >= 0) TakeOver(*instance, handle, of_name, next.get());
  }
  Settle(instance->last_solve, next.get());
  instance->rig = std::move(next->rig);
  instance->clips = std::move(next->clips);
  instance->state = std::move(next->state);
  instance->skins = std::move(next->skins);
  instance->wishes = std::move(next->wishes);
  instance->followers = std::move(next->followers);
  instance->recorder = nullptr;  // it was of the old rig
  return {};
}

}  // namespace
}  // namespace limber::capi

using namespace limber::capi;  // NOLINT(google-build-using-namespace): entry points in C's own

extern "C" {

LimberResult limberSwitchRig(LimberContext* context, LimberInstanceId instance, LimberRigId rig) {
  return CallOn(context, "limberSwitchRig", instance, [&](Instance* of) -> CallStatus {
    RigEntry* entry = context->rigs.Find({rig.index, rig.generation});
    return entry == nullptr ? StaleId("rig", rig.index, rig.generation) : Switch(entry, of);
  });
}

}  // extern "C"
