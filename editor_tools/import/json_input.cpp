#include "import/json_input.h"

#include "load/file_bytes.h"
#include "load/gltf_guard.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

// Larger coordinates are mistakes: sums of their squares would leave single precision.
constexpr double kLargestCoordinate = 1e15;

}  // namespace

Result<std::string> ReadTextFile(const std::filesystem::path& path) {
  Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, GltfLimits().max_file_bytes);
  if (!bytes.ok()) return bytes.status().WithContext(path.string());
  return std::string(bytes->begin(), bytes->end());
}

Result<Json> ParseInput(std::string_view text, const std::string& name) {
  GltfLimits limits;
  // A long recording of many handles, each of them a member of its frame.
  limits.max_json_values *= 8;
  limits.max_json_member_pairs *= 20;
  Result<Json> root = ParseJson(text, limits);
  if (!root.ok()) return root.status().WithContext(name);
  return root;
}

Status CheckMembers(const Json& object, const std::string& place,
                    std::initializer_list<const char*> known) {
  std::string list;
  for (const char* name : known)
    list += (list.empty() ? "" : ", ") + std::string(name);
  if (!object.is_object()) {
    return Status(StatusCode::kMalformed, place + ": an object with " + list + " is needed");
  }
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      return Error(StatusCode::kMalformed, "%s: \"%s\" is not known here; known are %s",
                   place.c_str(), key.c_str(), list.c_str());
    }
  }
  return {};
}

Result<Vec3> ReadPoint(const Json& value, const std::string& place) {
  if (!value.is_array() || value.size() != 3) {
    return Status(StatusCode::kMalformed, place + ": three numbers [x, y, z] are needed");
  }
  Vec3 point;
  for (size_t i = 0; i < 3; ++i) {
    const double number = value[i].is_number() ? value[i].get<double>() : NAN;
    if (!std::isfinite(number) || std::abs(number) > kLargestCoordinate) {
      return Status(StatusCode::kMalformed,
                    place + ": " + value[i].dump() + " is not a number of reasonable size");
    }
    point[static_cast<int>(i)] = static_cast<float>(number);
  }
  return point;
}

}  // namespace limber::bake
