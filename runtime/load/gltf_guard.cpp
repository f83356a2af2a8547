#include "load/gltf_guard.h"

#include "core/out_of_memory.h"
#include "core/printable.h"
#include "load/json_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kLargest = std::numeric_limits<int32_t>::max();

Status Malformed(const std::string& place, const std::string& reason) {
  return Status(StatusCode::kMalformed, place + ": " + reason);
}

std::string Place(const char* section, size_t index) {
  return std::string(section) + "[" + std::to_string(index) + "]";
}

// Depth, members and values counted from the bare characters, so that nothing is allocated for a
// bomb.
Status CheckNesting(std::string_view text, const GltfLimits& limits) {
  struct Open {
    bool is_object = false;
    uint64_t members = 1;
  };

  std::vector<Open> open;
  uint64_t num_values = 1, num_member_pairs = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') open.push_back({c == '{'});
    if ((c == ']' || c == '}') && !open.empty()) open.pop_back();
    if (c == ',' || c == '[' || c == '{') ++num_values;
    if (c == ',' && !open.empty() && open.back().is_object) {
      num_member_pairs += open.back().members++;
    }
    if (open.size() > static_cast<size_t>(std::max(0, limits.max_json_depth))) {
      return Error(StatusCode::kLimitExceeded,
                   "JSON byte %zu: nested deeper than %d levels; no exporter writes such a file", i,
                   limits.max_json_depth);
    }
    if (num_member_pairs > limits.max_json_member_pairs) {
      return Error(StatusCode::kLimitExceeded,
                   "JSON byte %zu: objects with too many members; no exporter writes such a file",
                   i);
    }
  }
  if (num_values > limits.max_json_values) {
    return Error(StatusCode::kLimitExceeded, "JSON: %llu values, the limit is %llu",
                 static_cast<unsigned long long>(num_values),
                 static_cast<unsigned long long>(limits.max_json_values));
  }
  return {};
}

// An integer member in [lowest, kLargest], or absent when it is not required.
Status CheckInteger(const Json& object, const char* key, const std::string& place, int64_t lowest,
                    bool required = false) {
  const auto it = object.find(key);
  if (it == object.end()) {
    return required ? Malformed(place, std::string("\"") + key + "\" is missing") : Status();
  }
  if (!it->is_number_integer()) {
    return Malformed(place, std::string("\"") + key + "\" is not an integer");
  }
  const bool too_large = it->is_number_unsigned() && it->get<uint64_t>() > uint64_t{kLargest};
  if (too_large || it->get<int64_t>() < lowest) {
    return Malformed(place, std::string("\"") + key + "\" is " + ShowJson(*it) + ", allowed are " +
                                std::to_string(lowest) + " to " + std::to_string(kLargest));
  }
  return {};
}

// An index member below `count`.
Status CheckIndex(const Json& object, const char* key, const std::string& place, size_t count,
                  bool required = false) {
  LIMBER_RETURN_IF_ERROR(CheckInteger(object, key, place, 0, required));
  const auto it = object.find(key);
  if (it != object.end() && it->get<uint64_t>() >= count) {
    return Malformed(place, std::string("\"") + key + "\" is " + ShowJson(*it) + ", the file has " +
                                std::to_string(count));
  }
  return {};
}

Status CheckString(const Json& object, const char* key, const std::string& place) {
  const auto it = object.find(key);
  if (it == object.end() || it->is_string()) return {};
  return Malformed(place, std::string("\"") + key + "\" is not a string");
}

// An array member of `size` finite numbers, or absent.
Status CheckNumbers(const Json& object, const char* key, const std::string& place, size_t size) {
  const auto it = object.find(key);
  if (it == object.end()) return {};
  bool good = it->is_array() && it->size() == size;
  for (size_t i = 0; good && i < size; ++i)
    good = (*it)[i].is_number();
  return good ? Status()
              : Malformed(place, std::string("\"") + key + "\" is not an array of " +
                                     std::to_string(size) + " numbers");
}

// An array of distinct or repeated indices below `count`, or absent.
Status CheckIndices(const Json& object, const char* key, const std::string& place, size_t count) {
  const auto it = object.find(key);
  if (it == object.end()) return {};
  if (!it->is_array()) return Malformed(place, std::string("\"") + key + "\" is not an array");
  for (const Json& index : *it) {
    if (!index.is_number_unsigned() || index.get<uint64_t>() >= count) {
      return Malformed(place, std::string("\"") + key + "\" holds " + ShowJson(index) +
                                  ", the file has " + std::to_string(count));
    }
  }
  return {};
}

size_t Count(const Json& root, const char* section) {
  const auto it = root.find(section);
  return it != root.end() && it->is_array() ? it->size() : 0;
}

Status CheckAsset(const Json& root) {
  const auto asset = root.find("asset");
  if (asset == root.end() || !asset->is_object()) return Malformed("asset", "missing");
  const auto version = asset->find("version");
  if (version == asset->end() || !version->is_string()) {
    return Malformed("asset", "\"version\" is missing");
  }
  if (version->get_ref<const std::string&>().substr(0, 2) != "2.") {
    return Status(StatusCode::kUnsupported,
                  "asset: glTF version " + ShowJson(*version) + "; export it as glTF 2.0");
  }
  return {};
}

Status CheckRequiredExtensions(const Json& root) {
  static constexpr std::array<std::string_view, 12> kHarmless = {
      // Quantised positions are decoded; the others change how a surface looks or is lit, not
      // where its vertices are.
      "KHR_mesh_quantization",  "KHR_texture_transform",
      "KHR_materials_unlit",    "KHR_lights_punctual",
      "KHR_texture_basisu",     "EXT_texture_webp",
      "KHR_materials_variants", "KHR_materials_transmission",
      "KHR_animation_pointer",  "KHR_materials_pbrSpecularGlossiness",
      "KHR_xmp_json_ld",        "EXT_texture_avif"};
  const auto required = root.find("extensionsRequired");
  if (required == root.end()) return {};
  if (!required->is_array()) return Malformed("extensionsRequired", "not an array");
  for (const Json& entry : *required) {
    if (!entry.is_string()) return Malformed("extensionsRequired", "holds something not a string");
    const auto& name = entry.get_ref<const std::string&>();
    if (std::find(kHarmless.begin(), kHarmless.end(), name) != kHarmless.end()) continue;
    const char* remedy = "export the file without it";
    if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression" ||
        name == "KHR_meshopt_compression") {
      remedy = "remove the compression with: npx @gltf-transform/cli copy IN.glb OUT.glb";
    }
    return Error(StatusCode::kUnsupported, "extensionsRequired: %s is not read by Limber; %s",
                 Quoted(name).c_str(), remedy);
  }
  return {};
}

Status CheckBuffer(const Json&, const Json& buffer, const std::string& place) {
  LIMBER_RETURN_IF_ERROR(CheckInteger(buffer, "byteLength", place, 1, true));
  return CheckString(buffer, "uri", place);
}

Status CheckBufferView(const Json& root, const Json& view, const std::string& place) {
  LIMBER_RETURN_IF_ERROR(CheckIndex(view, "buffer", place, Count(root, "buffers"), true));
  LIMBER_RETURN_IF_ERROR(CheckInteger(view, "byteOffset", place, 0));
  LIMBER_RETURN_IF_ERROR(CheckInteger(view, "byteLength", place, 1, true));
  LIMBER_RETURN_IF_ERROR(CheckInteger(view, "byteStride", place, 1));
  LIMBER_RETURN_IF_ERROR(CheckInteger(view, "target", place, 0));
  const int64_t end = view.value("byteOffset", int64_t{0}) + view["byteLength"].get<int64_t>();
  const int64_t size = root["buffers"][view["buffer"].get<size_t>()]["byteLength"].get<int64_t>();
  if (end > size) {
    return Malformed(
        place, "ends at byte " + std::to_string(end) + ", its buffer at " + std::to_string(size));
  }
  return {};
}

Status CheckSparse(const Json& sparse, const std::string& place, size_t num_views) {
  if (!sparse.is_object()) return Malformed(place, "not an object");
  LIMBER_RETURN_IF_ERROR(CheckInteger(sparse, "count", place, 1, true));
  for (const char* part : {"indices", "values"}) {
    const auto it = sparse.find(part);
    const std::string part_place = place + "." + part;
    if (it == sparse.end() || !it->is_object()) return Malformed(part_place, "missing");
    LIMBER_RETURN_IF_ERROR(CheckIndex(*it, "bufferView", part_place, num_views, true));
    LIMBER_RETURN_IF_ERROR(CheckInteger(*it, "byteOffset", part_place, 0));
  }
  return CheckInteger(sparse["indices"], "componentType", place + ".indices", 0, true);
}

Status CheckAccessor(const Json& root, const Json& accessor, const std::string& place) {
  const size_t num_views = Count(root, "bufferViews");
  LIMBER_RETURN_IF_ERROR(CheckIndex(accessor, "bufferView", place, num_views));
  LIMBER_RETURN_IF_ERROR(CheckInteger(accessor, "byteOffset", place, 0));
  LIMBER_RETURN_IF_ERROR(CheckInteger(accessor, "componentType", place, 0, true));
  LIMBER_RETURN_IF_ERROR(CheckInteger(accessor, "count", place, 1, true));
  LIMBER_RETURN_IF_ERROR(CheckString(accessor, "type", place));
  if (const auto it = accessor.find("normalized"); it != accessor.end() && !it->is_boolean()) {
    return Malformed(place, "\"normalized\" is not true or false");
  }
  const auto sparse = accessor.find("sparse");
  return sparse == accessor.end() ? Status() : CheckSparse(*sparse, place + ".sparse", num_views);
}

Status CheckAttributes(const Json& attributes, const std::string& place, size_t num_accessors) {
  if (!attributes.is_object()) return Malformed(place, "not an object");
  for (const auto& [name, index] : attributes.items()) {
    if (!index.is_number_unsigned() || index.get<uint64_t>() >= num_accessors) {
      return Malformed(place, Quoted(name) + " is accessor " + ShowJson(index) + ", the file has " +
                                  std::to_string(num_accessors));
    }
  }
  return {};
}

Status CheckPrimitive(const Json& root, const Json& primitive, const std::string& place) {
  if (!primitive.is_object()) return Malformed(place, "not an object");
  const size_t num_accessors = Count(root, "accessors");
  LIMBER_RETURN_IF_ERROR(CheckIndex(primitive, "indices", place, num_accessors));
  LIMBER_RETURN_IF_ERROR(CheckIndex(primitive, "material", place, Count(root, "materials")));
  LIMBER_RETURN_IF_ERROR(CheckInteger(primitive, "mode", place, 0));
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end()) return Malformed(place, "\"attributes\" is missing");
  LIMBER_RETURN_IF_ERROR(CheckAttributes(*attributes, place + ".attributes", num_accessors));
  const auto targets = primitive.find("targets");
  if (targets == primitive.end()) return {};
  if (!targets->is_array()) return Malformed(place, "\"targets\" is not an array");
  for (size_t t = 0; t < targets->size(); ++t) {
    LIMBER_RETURN_IF_ERROR(
        CheckAttributes((*targets)[t], place + "." + Place("targets", t), num_accessors));
  }
  return {};
}

Status CheckMesh(const Json& root, const Json& mesh, const std::string& place) {
  const auto primitives = mesh.find("primitives");
  if (primitives == mesh.end() || !primitives->is_array() || primitives->empty()) {
    return Malformed(place, "has no primitives");
  }
  for (size_t p = 0; p < primitives->size(); ++p) {
    LIMBER_RETURN_IF_ERROR(
        CheckPrimitive(root, (*primitives)[p], place + "." + Place("primitives", p)));
  }
  return CheckString(mesh, "name", place);
}

Status CheckNode(const Json& root, const Json& node, const std::string& place) {
  LIMBER_RETURN_IF_ERROR(CheckString(node, "name", place));
  LIMBER_RETURN_IF_ERROR(CheckIndex(node, "mesh", place, Count(root, "meshes")));
  LIMBER_RETURN_IF_ERROR(CheckIndices(node, "children", place, Count(root, "nodes")));
  LIMBER_RETURN_IF_ERROR(CheckNumbers(node, "matrix", place, 16));
  LIMBER_RETURN_IF_ERROR(CheckNumbers(node, "translation", place, 3));
  LIMBER_RETURN_IF_ERROR(CheckNumbers(node, "rotation", place, 4));
  return CheckNumbers(node, "scale", place, 3);
}

Status CheckScene(const Json& root, const Json& scene, const std::string& place) {
  return CheckIndices(scene, "nodes", place, Count(root, "nodes"));
}

using ItemCheck = Status (*)(const Json& root, const Json& item, const std::string& place);

Status CheckSection(const Json& root, const char* section, ItemCheck check) {
  const auto it = root.find(section);
  if (it == root.end()) return {};
  if (!it->is_array()) return Malformed(section, "not an array");
  for (size_t i = 0; i < it->size(); ++i) {
    const std::string place = Place(section, i);
    if (!(*it)[i].is_object()) return Malformed(place, "not an object");
    LIMBER_RETURN_IF_ERROR(check(root, (*it)[i], place));
    if (const auto x = (*it)[i].find("extensions"); x != (*it)[i].end() && !x->is_object()) {
      return Malformed(place, "\"extensions\" is not an object");
    }
  }
  return {};
}

// Every node has one parent at most, and following parents ends.
Status CheckForest(const Json& root) {
  const size_t num_nodes = Count(root, "nodes");
  std::vector<int64_t> parent(num_nodes, -1);
  for (size_t n = 0; n < num_nodes; ++n) {
    const auto children = root["nodes"][n].find("children");
    if (children == root["nodes"][n].end()) continue;
    for (const Json& child : *children) {
      int64_t& known = parent[child.get<size_t>()];
      if (known >= 0) {
        return Malformed(
            Place("nodes", child.get<size_t>()),
            "is a child of nodes " + std::to_string(known) + " and " + std::to_string(n));
      }
      known = static_cast<int64_t>(n);
    }
  }
  // A node of a cycle never reaches a root; visited nodes are marked with the walk's number.
  std::vector<size_t> walk(num_nodes, 0);
  for (size_t n = 0; n < num_nodes; ++n) {
    for (auto at = static_cast<int64_t>(n); at >= 0; at = parent[static_cast<size_t>(at)]) {
      size_t& mark = walk[static_cast<size_t>(at)];
      if (mark == n + 1) {
        return Malformed(Place("nodes", static_cast<size_t>(at)), "is its own ancestor");
      }
      if (mark != 0) break;
      mark = n + 1;
    }
  }
  return {};
}

}  // namespace

Result<Json> ParseJson(std::string_view text, const GltfLimits& limits) {
  LIMBER_RETURN_IF_ERROR(CheckNesting(text, limits));
  constexpr size_t kLongestReason = 200;
  return CatchOutOfMemory("JSON", [&]() -> Result<Json> {
    try {
      return Json::parse(text);
    } catch (const Json::exception& error) {
      // The library's text reads "[json.exception...] parse error at line 1, column 2: ...".
      const std::string what = error.what();
      const size_t bracket = what.find("] ");
      return Status(
          StatusCode::kMalformed,
          "JSON: " + Printable(what.substr(bracket == std::string::npos ? 0 : bracket + 2),
                               kLongestReason));
    }
  });
}

Status CheckGltfStructure(const Json& root) {
  if (!root.is_object()) return Malformed("JSON", "the root is not an object");
  LIMBER_RETURN_IF_ERROR(CheckAsset(root));
  LIMBER_RETURN_IF_ERROR(CheckRequiredExtensions(root));
  if (const auto it = root.find("extensions"); it != root.end() && !it->is_object()) {
    return Malformed("extensions", "not an object");
  }
  LIMBER_RETURN_IF_ERROR(CheckSection(root, "buffers", CheckBuffer));
  LIMBER_RETURN_IF_ERROR(CheckSection(root, "bufferViews", CheckBufferView));
  LIMBER_RETURN_IF_ERROR(CheckSection(root, "accessors", CheckAccessor));
  LIMBER_RETURN_IF_ERROR(CheckSection(root, "meshes", CheckMesh));
  LIMBER_RETURN_IF_ERROR(CheckSection(root, "nodes", CheckNode));
  LIMBER_RETURN_IF_ERROR(CheckSection(root, "scenes", CheckScene));
  return CheckForest(root);
}

}  // namespace limber
