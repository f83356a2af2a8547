// The frames file of `limber solve` and `limber render`:
//   {"frames": [{"targets": {"handle name": [x, y, z]}}]}
#pragma once

#include "core/status.h"
#include "core/vec3.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace limber::bake {

// Targets of one frame in mesh space, in the file's order; a handle that is absent keeps its last
// target. Whether the names exist is checked later, against the rig.
using FrameTargets = std::vector<std::pair<std::string, Vec3>>;

// Errors, naming file, frame and handle: kNotFound, kIoError, kMalformed (not JSON, unknown
// members, wrong types, numbers that are not finite or beyond 1e15, no frame).
Result<std::vector<FrameTargets>> ReadFramesFile(const std::filesystem::path& path);
Result<std::vector<FrameTargets>> ParseFrames(std::string_view text, const std::string& name);

}  // namespace limber::bake
