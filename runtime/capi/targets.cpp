// limber.h: where handles are to be.
#include "capi/inputs.h"

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberResult limberSetTarget(LimberContext* context, LimberInstanceId instance, int32_t handle,
                             const float position[3]) {
  return CallOn(context, "limberSetTarget", instance, [&](Instance* of) -> CallStatus {
    if (position == nullptr) return NullArgument("position");
    return Ask(TargetEvent(handle, {position[0], position[1], position[2]}), of);
  });
}

LimberResult limberSetTargetRotation(LimberContext* context, LimberInstanceId instance,
                                     int32_t handle, const float rotation[4], float stiffness) {
  return CallOn(context, "limberSetTargetRotation", instance, [&](Instance* of) -> CallStatus {
    if (rotation == nullptr) return NullArgument("rotation");
    const Quaternion turn = {rotation[0], rotation[1], rotation[2], rotation[3]};
    return Ask(RotationEvent(handle, turn, stiffness), of);
  });
}

LimberResult limberClearTargetRotation(LimberContext* context, LimberInstanceId instance,
                                       int32_t handle) {
  return CallOn(context, "limberClearTargetRotation", instance, [&](Instance* of) {
    return Ask(HandleEvent(InputKind::kClearRotation, handle), of);
  });
}

LimberResult limberResetToRest(LimberContext* context, LimberInstanceId instance) {
  return CallOn(context, "limberResetToRest", instance,
                [&](Instance* of) { return Ask(HandleEvent(InputKind::kResetToRest, 0), of); });
}

}  // extern "C"
