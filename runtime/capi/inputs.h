// What is asked of an instance goes this one way: to its state, into what another rig would take
// over, and into its recording.
#pragma once

#include "capi/context.h"
#include "drive/input_events.h"

namespace limber::capi {

InputEvent TargetEvent(int32_t handle, Vec3 position);
InputEvent RotationEvent(int32_t handle, Quaternion rotation, float stiffness);
// Of a handle (or grab), with a stiffness or weight where the kind has one.
InputEvent HandleEvent(InputKind kind, int32_t index, float number = 0);

// grab: the number of a grab that was made; may be null for other events.
CallStatus Ask(const InputEvent& event, Instance* instance, int32_t* grab = nullptr);

std::unique_ptr<InputRecorder> MakeRecorder(const Rig& rig, const PoseRoom& room);

// After a solve of an instance that has a recorder. Where there is no memory for more, the
// recording ends: it is no reason to lose a frame.
void RecordSolve(const PoseOptions& options, int iterations, Instance* instance);

}  // namespace limber::capi
