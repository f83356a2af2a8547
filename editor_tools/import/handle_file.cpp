#include "import/handle_file.h"

#include "core/vector.h"
#include "import/json_input.h"

#include <nlohmann/json.hpp>

#include <limits>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

Result<HandleSpec> ReadHandle(const Json& entry, const std::string& place) {
  LIMBER_RETURN_IF_ERROR(
      CheckMembers(entry, place, {"name", "vertex", "position", "free", "stiffness"}));
  HandleSpec spec;
  const auto name = entry.find("name");
  if (name == entry.end() || !name->is_string() || name->get_ref<const std::string&>().empty()) {
    return Status(StatusCode::kMalformed, place + ".name: a name in quotes is needed");
  }
  spec.name = name->get<std::string>();
  const std::string named = place + " \"" + spec.name + "\"";
  if (const auto vertex = entry.find("vertex"); vertex != entry.end()) {
    if (!vertex->is_number_unsigned() ||
        vertex->get<uint64_t>() > std::numeric_limits<uint32_t>::max()) {
      return Status(StatusCode::kMalformed,
                    named + ": vertex " + vertex->dump() + " is not a vertex number from 0 up");
    }
    spec.source_vertex = vertex->get<uint32_t>();
  }
  if (const auto position = entry.find("position"); position != entry.end()) {
    Result<Vec3> point = ReadPoint(*position, named + ": position");
    if (!point.ok()) return point.status();
    spec.position = *point;
  }
  if (spec.source_vertex.has_value() == spec.position.has_value()) {
    return Status(StatusCode::kMalformed,
                  named + ": give it either \"vertex\" or \"position\", one of the two");
  }
  if (const auto is_free = entry.find("free"); is_free != entry.end()) {
    if (!is_free->is_boolean()) {
      return Status(StatusCode::kMalformed, named + ": free is neither true nor false");
    }
    spec.pinned = !is_free->get<bool>();
  }
  if (const auto stiffness = entry.find("stiffness"); stiffness != entry.end()) {
    spec.stiffness = stiffness->is_number() ? stiffness->get<double>() : 0;
    if (!IsRegionStiffness(spec.stiffness)) {
      return Status(StatusCode::kMalformed, named + ": stiffness " + stiffness->dump() +
                                                " is not a number from 0.001 to 1000");
    }
  }
  return spec;
}

}  // namespace

Result<Vector<HandleSpec>> ParseHandles(std::string_view text, const std::string& name) {
  Result<Json> root = ParseInput(text, name);
  if (!root.ok()) return root.status();
  LIMBER_RETURN_IF_ERROR(CheckMembers(*root, "the root", {"handles"}).WithContext(name));
  const auto handles = root->find("handles");
  if (handles == root->end() || !handles->is_array()) {
    return Error(StatusCode::kMalformed, "%s: handles: a list is needed", name.c_str());
  }
  if (handles->empty()) {
    return Error(StatusCode::kNoHandles, "%s: handles: the list is empty", name.c_str());
  }
  Vector<HandleSpec> specs;
  for (size_t i = 0; i < handles->size(); ++i) {
    Result<HandleSpec> spec = ReadHandle((*handles)[i], "handles[" + std::to_string(i) + "]");
    if (!spec.ok()) return spec.status().WithContext(name);
    specs.push_back(std::move(*spec));
  }
  return specs;
}

Result<Vector<HandleSpec>> ReadHandleFile(const std::filesystem::path& path) {
  Result<std::string> text = ReadTextFile(path);
  if (!text.ok()) return text.status();
  return ParseHandles(*text, path.string());
}

}  // namespace limber::bake
