#include "bake/write_baked.h"

#include "bake/handle_nodes.h"
#include "bake/pack_tables.h"
#include "core/vector.h"
#include "gltf_edit/gltf_patch.h"
#include "import/file_output.h"
#include "load/gltf_mesh.h"
#include "load/rig_json.h"
#include "load/rig_loader.h"
#include "rig/rig_fields.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

// The source as it is on the disk now, and the changes to it.
struct OpenSource {
  GltfFile file;
  GltfMorphMesh mesh;
  GltfPatch patch;
};

Result<OpenSource> Open(const std::filesystem::path& source, const RawCharacter& raw,
                        const std::filesystem::path& out) {
  const std::string extension = out.extension().string();
  if (extension != ".glb" && extension != ".gltf") {
    return Error(StatusCode::kInvalidArgument, "%s: output: the name must end with .glb or .gltf",
                 out.string().c_str());
  }
  Result<GltfFile> file = GltfFile::Open(source);
  if (!file.ok()) return file.status();
  Result<GltfMorphMesh> mesh = ReadMorphMesh(*file, raw.mesh);
  if (!mesh.ok()) return mesh.status();
  Result<GltfPatch> patch = GltfPatch::Begin(*file);
  if (!patch.ok()) return patch.status();
  return OpenSource{std::move(*file), std::move(*mesh), std::move(*patch)};
}

Status CheckFits(const RawCharacter& raw, size_t num_shapes, size_t num_draw_vertices,
                 size_t num_primitives, const OpenSource& source) {
  const GltfMorphMesh& mesh = source.mesh;
  const auto nodes = source.file.json().find("nodes");
  const bool node_fits = nodes != source.file.json().end() && raw.node >= 0 &&
                         static_cast<size_t>(raw.node) < nodes->size() &&
                         (*nodes)[static_cast<size_t>(raw.node)].value("mesh", -1) == raw.mesh;
  const bool shapes_fit =
      num_shapes == mesh.targets.size() || num_shapes == mesh.targets.size() + 1;
  if (node_fits && shapes_fit && num_draw_vertices == mesh.positions.size() &&
      num_primitives == mesh.primitives.size()) {
    return {};
  }
  return Error(StatusCode::kInvalidArgument,
               "mesh \"%s\": it is not the one that was baked; bake again from this file",
               mesh.name.c_str());
}

Status CheckLimits(const GltfMorphMesh& mesh, size_t num_handles) {
  const GltfLimits limits;
  if (num_handles > limits.max_handles) {
    return Error(StatusCode::kLimitExceeded, "handles: %zu are too many, the limit is %llu",
                 num_handles, static_cast<unsigned long long>(limits.max_handles));
  }
  if (uint64_t{mesh.num_vertices()} * num_handles > limits.max_weights) {
    return Error(StatusCode::kLimitExceeded,
                 "mesh \"%s\": %u vertices times %zu handles are more than the limit of %llu; "
                 "bake with fewer handles",
                 mesh.name.c_str(), mesh.num_vertices(), num_handles,
                 static_cast<unsigned long long>(limits.max_weights));
  }
  return {};
}

// The extension object, made where there is none. Another version's numbers mean something else.
Result<Json*> OpenExtension(Json* root) {
  Json& extensions = (*root)["extensions"];
  if (extensions.is_null()) extensions = Json::object();
  Json& own = extensions[kRigExtensionName];
  if (!own.is_object()) own = {{"version", kRigFormatVersion}, {"rigs", Json::array()}};
  if (own.value("version", Json()) != kRigFormatVersion) {
    return Error(
        StatusCode::kVersionMismatch,
        "extensions.%s.version: it is %s, this Limber writes %d; bake from the source file",
        kRigExtensionName, own.value("version", Json()).dump().c_str(), kRigFormatVersion);
  }
  if (!own["rigs"].is_array()) own["rigs"] = Json::array();
  return &own;
}

// The rig of an earlier bake of that mesh, else the next free number.
size_t ChooseRigIndex(const Json& root, const Json& rigs, int mesh) {
  for (const Json& node : root["nodes"]) {
    if (node.value("mesh", -1) != mesh || !node.contains("extensions")) continue;
    const auto own = node["extensions"].find(kRigExtensionName);
    if (own == node["extensions"].end() || !own->is_object()) continue;
    const auto rig = own->find("rig");
    if (rig != own->end() && rig->is_number_unsigned() && rig->get<size_t>() < rigs.size()) {
      return rig->get<size_t>();
    }
  }
  return rigs.size();
}

// Unlinks an earlier bake's attributes and tables; returns the accessors.
Vector<size_t> UnlinkOldBake(Json* primitives, Json* rig) {
  Vector<size_t> accessors;
  const auto keep = [&accessors](const Json& index) {
    if (index.is_number_unsigned()) accessors.push_back(index.get<size_t>());
  };
  for (Json& primitive : *primitives) {
    Json kept = Json::object();
    for (const auto& [name, index] : primitive["attributes"].items()) {
      if (name == kWeldAttribute || name == kGroupAttribute ||
          name.rfind(kWeightsAttributePrefix, 0) == 0) {
        keep(index);
      } else {
        kept[name] = index;
      }
    }
    primitive["attributes"] = std::move(kept);
  }
  if (rig != nullptr && rig->is_object() && rig->contains("tables")) {
    for (const Json& table : (*rig)["tables"]) {
      if (table.is_object() && table.contains("accessor")) keep(table["accessor"]);
    }
    rig->erase("tables");
  }
  return accessors;
}

// Per-vertex data of one primitive, solve vertices expanded to draw vertices.
void AddAttributes(const BakedCharacter& baked, const SkinPrimitive& primitive, GltfPatch* patch,
                   Json* attributes) {
  const SkinMesh& mesh = baked.mesh;
  constexpr size_t kPerAttribute = 4;
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  const auto* solve = mesh.solve_vertex.data() + primitive.first_vertex;
  const Vector<float> weld(solve, solve + primitive.num_vertices);
  (*attributes)[kWeldAttribute] = patch->AddFloats(kWeldAttribute, weld, 1, true);
  if (!baked.vertex_groups.empty()) {
    Vector<float> groups(primitive.num_vertices);
    for (size_t v = 0; v < groups.size(); ++v)
      groups[v] = static_cast<float>(baked.vertex_groups[solve[v]]);
    (*attributes)[kGroupAttribute] = patch->AddFloats(kGroupAttribute, groups, 1, true);
  }
  for (size_t first = 0; first < num_handles; first += kPerAttribute) {
    Vector<float> rows(kPerAttribute * primitive.num_vertices, 0.0f);
    const size_t used = std::min(kPerAttribute, num_handles - first);
    for (size_t v = 0; v < primitive.num_vertices; ++v) {
      const float* weights = mesh.weights.data() + solve[v] * num_handles + first;
      std::copy(weights, weights + used, rows.begin() + static_cast<ptrdiff_t>(kPerAttribute * v));
    }
    const std::string name = kWeightsAttributePrefix + std::to_string(first / kPerAttribute);
    (*attributes)[name] = patch->AddFloats(name, rows, kPerAttribute, true);
  }
}

RigJson DescribeRig(const BakedCharacter& baked, const Vector<PackedTable>& tables,
                    const GltfMorphMesh& mesh, GltfPatch* patch) {
  RigJson rig;
  rig.num_vertices = mesh.num_vertices();
  rig.num_solve_vertices = baked.mesh.num_solve_vertices;
  rig.mesh_hash = HashMesh(mesh);
  const auto num_shapes = static_cast<int>(baked.tables.shape_names.size());
  const int base = num_shapes - static_cast<int>(mesh.targets.size());  // 1 when it is a shape
  for (int s = 0; s < num_shapes; ++s)
    rig.shape_targets.push_back(s - base);
  for (const PackedTable& table : tables) {
    const size_t accessor =
        patch->AddBytes(std::string(kRigExtensionName) + "." + table.name, table.bytes);
    rig.table_accessors[table.name] = {static_cast<int>(accessor), table.shape, table.exponent};
  }
  rig.tables = baked.tables;
  return rig;
}

void NoteExtensionUsed(Json* root) {
  Json& used = (*root)["extensionsUsed"];
  if (!used.is_array()) used = Json::array();
  if (std::find(used.begin(), used.end(), kRigExtensionName) == used.end()) {
    used.push_back(kRigExtensionName);
  }
}

// One for each handle, also where the bake was put together by hand and has none.
Vector<double> StiffnessOfHandles(const BakedCharacter& baked) {
  Vector<double> stiffness = baked.handle_stiffness;
  stiffness.resize(baked.tables.handles.size(), 1);
  return stiffness;
}

Status PatchRig(const RawCharacter& raw, const BakedCharacter& baked, const GltfMorphMesh& mesh,
                GltfPatch* patch, size_t* rig_index) {
  const auto tables = PackRigTables(baked.tables, baked.local_factors);
  if (!tables.ok()) return tables.status();
  Json& root = patch->json();
  Result<Json*> extension = OpenExtension(&root);
  if (!extension.ok()) return extension.status();
  Json& rigs = (**extension)["rigs"];
  *rig_index = ChooseRigIndex(root, rigs, raw.mesh);
  const bool replaces = *rig_index < rigs.size();
  const Json old_rig = replaces ? rigs[*rig_index] : Json();
  Json& primitives = root["meshes"][static_cast<size_t>(raw.mesh)]["primitives"];
  patch->RemoveAccessors(UnlinkOldBake(&primitives, replaces ? &rigs[*rig_index] : nullptr));
  for (const SkinPrimitive& primitive : baked.mesh.primitives) {
    AddAttributes(baked, primitive, patch,
                  &primitives[static_cast<size_t>(primitive.gltf_primitive)]["attributes"]);
  }
  RigJson rig = DescribeRig(baked, *tables, mesh, patch);
  PlaceHandleNodes(old_rig, raw.node, StiffnessOfHandles(baked), &rig.tables.handles, &root);
  Json entry = WriteRigJson(raw.name, rig);
  if (replaces) {
    rigs[*rig_index] = std::move(entry);
  } else {
    rigs.push_back(std::move(entry));
  }
  root["nodes"][static_cast<size_t>(raw.node)]["extensions"][kRigExtensionName] = {
      {"rig", *rig_index}};
  NoteExtensionUsed(&root);
  return {};
}

}  // namespace

Status CheckBeforeBake(const std::filesystem::path& source, const RawCharacter& raw,
                       size_t num_handles, const std::filesystem::path& out) {
  Result<OpenSource> open = Open(source, raw, out);
  if (!open.ok()) return open.status();
  const std::string& name = open->file.name();
  LIMBER_RETURN_IF_ERROR(CheckFits(raw, raw.shapes.size(),
                                   static_cast<size_t>(raw.num_draw_vertices()),
                                   raw.primitives.size(), *open)
                             .WithContext(name));
  LIMBER_RETURN_IF_ERROR(CheckLimits(open->mesh, num_handles).WithContext(name));
  LIMBER_RETURN_IF_ERROR(OpenExtension(&open->patch.json()).status().WithContext(name));
  return CheckOutputPlace(out);
}

Status WriteBaked(const std::filesystem::path& source, const RawCharacter& raw,
                  const BakedCharacter& baked, const std::filesystem::path& out) {
  Result<OpenSource> open = Open(source, raw, out);
  if (!open.ok()) return open.status();
  const std::string& name = open->file.name();
  LIMBER_RETURN_IF_ERROR(CheckFits(raw, baked.tables.shape_names.size(),
                                   baked.mesh.solve_vertex.size(), baked.mesh.primitives.size(),
                                   *open)
                             .WithContext(name));
  size_t rig_index = 0;
  LIMBER_RETURN_IF_ERROR(
      PatchRig(raw, baked, open->mesh, &open->patch, &rig_index).WithContext(name));
  Result<Vector<uint8_t>> bytes = open->patch.Finish(out.extension() == ".glb");
  if (!bytes.ok()) return bytes.status().WithContext(out.string());
  RigLoadOptions options;
  options.rig_index = static_cast<int>(rig_index);
  const auto rig = LoadRigFromMemory(*bytes, out.string(), options);
  if (!rig.ok()) return rig.status().WithContext("the bake would not load again, nothing written");
  return WriteFileAtomically(out, *bytes);
}

}  // namespace limber::bake
