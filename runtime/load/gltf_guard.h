// Looks a glTF's JSON over before tinygltf sees it: tinygltf recurses without a limit, wraps large
// integers to 32 bits, drops what it cannot read and checks no index.
#pragma once

#include "core/status.h"
#include "load/gltf_limits.h"

#include <nlohmann/json_fwd.hpp>

#include <string_view>

namespace limber {

// Parses the text after checking its nesting depth and its numbers of values and members. Errors:
// kMalformed with the byte's position, kLimitExceeded, kOutOfMemory.
Result<nlohmann::ordered_json> ParseJson(std::string_view text, const GltfLimits& limits);

// Checks the root's structure: asset version 2, required extensions that Limber reads, and in
// buffers, bufferViews, accessors, meshes, nodes and scenes that every member that is read has its
// type and every index its range, and that the node hierarchy is a forest. Errors: kMalformed,
// kUnsupported (a required extension, by name).
Status CheckGltfStructure(const nlohmann::ordered_json& root);

}  // namespace limber
