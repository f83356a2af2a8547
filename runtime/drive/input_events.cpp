#include "drive/input_events.h"

namespace limber {

Status ApplyInput(const InputEvent& event, PoseState* state, int* grab) {
  switch (event.kind) {
    case InputKind::kTarget:
      return state->SetTarget(event.index, event.position);
    case InputKind::kRotation:
      return state->SetRotation(event.index, event.rotation, event.number);
    case InputKind::kClearRotation:
      return state->ClearRotation(event.index);
    case InputKind::kResetToRest:
      state->ResetToRest();
      return {};
    case InputKind::kPin:
      return state->Pin(event.index);
    case InputKind::kUnpin:
      return state->Unpin(event.index);
    case InputKind::kStiffness:
      return state->SetStiffness(event.index, event.number);
    case InputKind::kWeight:
      return state->SetWeight(event.index, event.number);
    case InputKind::kGrab: {
      const Result<int> made = state->Grab(event.point, event.number);
      if (made.ok()) *grab = *made;
      return made.status();
    }
    case InputKind::kGrabTarget:
      return state->SetGrabTarget(event.index, event.position);
    case InputKind::kRelease:
      return state->Release(event.index);
    case InputKind::kOptions:
      return {};
    case InputKind::kSolve:
      return state->Solve(event.options, nullptr);
  }
  return Error(StatusCode::kInvalidArgument, "input event %d is none",
               static_cast<int>(event.kind));
}

}  // namespace limber
