#include "gltf_edit/append_targets.h"

#include "core/printable.h"
#include "gltf_edit/extend_weights.h"
#include "load/gltf_accessor.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

size_t NumTargets(const Json& primitive) {
  const auto targets = primitive.find("targets");
  return targets == primitive.end() ? 0 : targets->size();
}

size_t MostTargets(const Json& primitives) {
  size_t most = 0;
  for (const Json& primitive : primitives)
    most = std::max(most, NumTargets(primitive));
  return most;
}

// The names of the mesh's targets; those that the file does not name are numbered, as readers do.
Result<Json> ExtendNames(const Json& mesh, size_t num_old, std::span<const NewTarget> targets) {
  Json names = Json::array();
  const auto extras = mesh.find("extras");
  if (extras != mesh.end() && extras->is_object()) names = extras->value("targetNames", names);
  if (!names.is_array()) names = Json::array();
  while (names.size() > num_old)
    names.erase(names.size() - 1);
  while (names.size() < num_old)
    names.push_back("target_" + std::to_string(names.size()));
  for (const NewTarget& target : targets) {
    if (std::find(names.begin(), names.end(), Json(target.name)) != names.end()) {
      return Error(StatusCode::kInvalidArgument,
                   "morph target %s: the mesh has one of that name already; begin with the source "
                   "file, or choose other moments",
                   Quoted(target.name).c_str());
    }
    names.push_back(target.name);
  }
  return names;
}

// Targets at rest, for a primitive that had none beside primitives with some.
void AddRestTargets(const GltfFile& source, size_t count, GltfPatch* patch, Json* primitive) {
  if (NumTargets(*primitive) > 0 || count == 0) return;
  const auto num_vertices =
      static_cast<size_t>(AccessorCount(source, (*primitive)["attributes"]["POSITION"].get<int>()));
  const size_t zeros = patch->AddZeroVectors("rest", num_vertices);
  (*primitive)["targets"] = Json::array();
  for (size_t t = 0; t < count; ++t)
    (*primitive)["targets"].push_back({{"POSITION", zeros}});
}

void AddTarget(const NewTarget& target, size_t p, GltfPatch* patch, Json* primitive) {
  const TargetOffsets& offsets = target.primitives[p];
  Json entry = {{"POSITION", patch->AddVectors(target.name, offsets.positions, true)}};
  if (!offsets.normals.empty()) {
    entry["NORMAL"] = patch->AddVectors(target.name + " normals", offsets.normals, false);
  }
  if (!primitive->contains("targets")) (*primitive)["targets"] = Json::array();
  (*primitive)["targets"].push_back(std::move(entry));
}

}  // namespace

Status AppendTargets(const GltfFile& source, int mesh, std::span<const NewTarget> targets,
                     GltfPatch* patch) {
  const auto index = static_cast<size_t>(mesh);
  const size_t num_old = MostTargets(patch->json()["meshes"][index]["primitives"]);
  Result<Json> names = ExtendNames(patch->json()["meshes"][index], num_old, targets);
  if (!names.ok()) return names.status();
  LIMBER_RETURN_IF_ERROR(ExtendWeights(source, mesh, {num_old, targets.size()}, patch));
  // A copy: adding an accessor may move what lies in the root.
  Json json = patch->json()["meshes"][index];
  for (size_t p = 0; p < json["primitives"].size(); ++p) {
    Json& primitive = json["primitives"][p];
    AddRestTargets(source, num_old, patch, &primitive);
    for (const NewTarget& target : targets)
      AddTarget(target, p, patch, &primitive);
  }
  if (!json.contains("extras")) json["extras"] = Json::object();
  if (json["extras"].is_object()) json["extras"]["targetNames"] = std::move(*names);
  patch->json()["meshes"][index] = std::move(json);
  return {};
}

}  // namespace limber::bake
