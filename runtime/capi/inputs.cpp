#include "capi/inputs.h"

#include "drive/rig_hash.h"

#include <algorithm>

namespace limber::capi {
namespace {

void Record(const InputEvent& event, Instance* instance) {
  try {
    instance->recorder->Add(event);
  } catch (const std::bad_alloc&) {
    instance->recorder = nullptr;
  }
}

// What another rig will be asked for.
void Remember(const InputEvent& event, Instance* instance) {
  if (event.kind == InputKind::kResetToRest) {
    std::fill(instance->wishes.begin(), instance->wishes.end(), HandleWishes());
    return;
  }
  const auto index = static_cast<size_t>(event.index);
  if (event.kind == InputKind::kStiffness) instance->wishes[index].stiffness = event.number;
  if (event.kind == InputKind::kWeight) instance->wishes[index].weight = event.number;
  if (event.kind == InputKind::kClearRotation) instance->wishes[index].is_turned = false;
  if (event.kind != InputKind::kRotation) return;
  HandleWishes& wishes = instance->wishes[index];
  wishes.is_turned = true;
  wishes.rotation = event.rotation;
  wishes.rotation_stiffness = event.number;
}

}  // namespace

InputEvent HandleEvent(InputKind kind, int32_t index, float number) {
  InputEvent event;
  event.kind = kind;
  event.index = index;
  event.number = number;
  return event;
}

InputEvent TargetEvent(int32_t handle, Vec3 position) {
  InputEvent event = HandleEvent(InputKind::kTarget, handle);
  event.position = position;
  return event;
}

InputEvent RotationEvent(int32_t handle, Quaternion rotation, float stiffness) {
  InputEvent event = HandleEvent(InputKind::kRotation, handle, stiffness);
  event.rotation = rotation;
  return event;
}

CallStatus Ask(const InputEvent& event, Instance* instance, int32_t* grab) {
  int made = 0;
  LIMBER_RETURN_IF_FAILED(ApplyInput(event, &instance->state, &made));
  Remember(event, instance);
  if (grab != nullptr) *grab = made;
  if (instance->recorder == nullptr) return {};
  InputEvent recorded = event;
  if (event.kind == InputKind::kGrab) recorded.index = made;
  Record(recorded, instance);
  return {};
}

std::unique_ptr<InputRecorder> MakeRecorder(const Rig& rig, const PoseRoom& room) {
  return std::make_unique<InputRecorder>(RecordingHead{HashRig(rig), room});
}

void RecordSolve(const PoseOptions& options, int iterations, Instance* instance) {
  InputEvent event;
  event.options = options;
  event.iterations = iterations;
  event.pose_hash = HashPose(instance->state.transforms());
  Record(event, instance);
}

}  // namespace limber::capi
