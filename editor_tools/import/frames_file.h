// The frames file of `limber solve` and `limber render`:
//   {"frames": [{"targets": {"handle name": [x, y, z]}}]}
// and, each optional, beside "targets":
//   "pinned": {"handle name": true or false}        held or let go
//   "stiffness": {"handle name": number or null}    of the pull to its target; null: exactly
//   "weights": {"handle name": number or null}      against a stretch limit; null: never gives way
//   "rotations": {"handle name": [x, y, z, w] or null}   of the skin around it; null: none
#pragma once

#include "core/quaternion.h"
#include "core/status.h"
#include "core/vec3.h"
#include "core/vector.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace limber::bake {

// What one frame says of one handle, in one of its members; exactly one of the values is there.
struct HandleInput {
  std::string handle;
  std::optional<bool> pinned;
  std::optional<float> stiffness;  // infinite: exactly
  std::optional<float> weight;     // infinite: never gives way
  std::optional<Vec3> target;      // mesh space
  std::optional<Quaternion> rotation;
  bool clears_rotation = false;
};

// In the order in which they take effect: pins, stiffnesses, weights, targets, rotations. A handle
// that a frame does not mention stays as it was. Whether the names exist is checked later, against
// the rig.
using FrameInput = Vector<HandleInput>;

// Errors, naming file, frame and handle: kNotFound, kIoError, kMalformed (not JSON, unknown
// members, wrong types, numbers that are not finite or beyond 1e15, no frame).
Result<Vector<FrameInput>> ReadFramesFile(const std::filesystem::path& path);
Result<Vector<FrameInput>> ParseFrames(std::string_view text, const std::string& name);

}  // namespace limber::bake
