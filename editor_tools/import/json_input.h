// What the readers of small hand-written JSON files share.
#pragma once

#include "core/status.h"
#include "core/vec3.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace limber::bake {

// The whole file; errors begin with the path.
Result<std::string> ReadTextFile(const std::filesystem::path& path);

// Parses JSON of limited size and depth; errors begin with `name`.
Result<nlohmann::ordered_json> ParseInput(std::string_view text, const std::string& name);

// Refuses what is not an object, and members that are not in `known`: a misspelt one must not be
// overlooked. Errors begin with `place`.
Status CheckMembers(const nlohmann::ordered_json& object, const std::string& place,
                    std::initializer_list<const char*> known);

// Three finite numbers that fit a float. Errors begin with `place`.
Result<Vec3> ReadPoint(const nlohmann::ordered_json& value, const std::string& place);

}  // namespace limber::bake
