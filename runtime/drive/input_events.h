// What can be asked of a character, as one event after the other: the content of a recording.
#pragma once

#include "core/quaternion.h"
#include "core/status.h"
#include "core/vec3.h"
#include "rig/skin_point.h"
#include "solve/pose_solver.h"

#include <cstdint>

namespace limber {

// The numbers stand in files: never change one.
enum class InputKind : uint8_t {
  kTarget = 1,
  kRotation = 2,
  kClearRotation = 3,
  kResetToRest = 4,
  kPin = 5,
  kUnpin = 6,
  kStiffness = 7,
  kWeight = 8,
  kGrab = 9,
  kGrabTarget = 10,
  kRelease = 11,
  kOptions = 12,  // of the solves from here on
  kSolve = 13,
};

struct InputEvent {
  InputKind kind = InputKind::kSolve;
  int32_t index = 0;  // handle or grab
  Vec3 position;      // of a target, mesh space
  Quaternion rotation;
  float number = 0;        // stiffness or weight
  SkinPoint point;         // grabbed
  PoseOptions options;     // kOptions
  int32_t iterations = 0;  // kSolve: alternations that were done
  uint64_t pose_hash = 0;  // kSolve: HashPose of what came out
};

// What a recording begins with.
struct RecordingHead {
  uint64_t rig_hash = 0;
  PoseRoom room;
};

// Asks an event of a state. A grab's number comes back in *grab. Errors: those of PoseState's own
// calls.
Status ApplyInput(const InputEvent& event, PoseState* state, int* grab);

}  // namespace limber
