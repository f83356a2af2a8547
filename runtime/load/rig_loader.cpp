#include "load/rig_loader.h"

#include "core/out_of_memory.h"
#include "core/printable.h"
#include "core/vector.h"
#include "load/gltf_accessor.h"
#include "load/gltf_mesh.h"
#include "load/json_text.h"
#include "load/rig_json.h"
#include "load/rig_table_reader.h"
#include "rig/rest_frames.h"
#include "rig/rig_fields.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

const Json* FindExtension(const Json& object) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return nullptr;
  const auto it = extensions->find(kRigExtensionName);
  return it != extensions->end() && it->is_object() ? &*it : nullptr;
}

// The entry of "rigs", and the version, found to be one that this code reads.
struct VersionedRig {
  const Json* json = nullptr;
  int version = 0;
};

Result<VersionedRig> FindRig(const GltfFile& file, int index) {
  const Json* extension = FindExtension(file.json());
  if (extension == nullptr) {
    return Error(StatusCode::kUnsupported,
                 "extensions: no %s, so the file was not baked; run: limber bake IN -o OUT.glb",
                 kRigExtensionName);
  }
  const std::string place = std::string("extensions.") + kRigExtensionName;
  const auto version = extension->find("version");
  if (version == extension->end() || !version->is_number_integer()) {
    return Status(StatusCode::kMalformed, place + ".version: it is missing or not an integer");
  }
  if (*version < kOldestRigFormatVersion || *version > kRigFormatVersion) {
    return Status(StatusCode::kVersionMismatch,
                  place + ".version: it is " + ShowJson(*version) + ", this Limber reads " +
                      std::to_string(kOldestRigFormatVersion) + " to " +
                      std::to_string(kRigFormatVersion) +
                      "; update Limber, or bake the character again with this one");
  }
  const auto rigs = extension->find("rigs");
  if (rigs == extension->end() || !rigs->is_array()) {
    return Status(StatusCode::kMalformed, place + ".rigs: it is missing or not an array");
  }
  if (index < 0 || static_cast<size_t>(index) >= rigs->size()) {
    return Error(StatusCode::kInvalidArgument, "%s.rigs: rig %d is wanted, the file has %zu",
                 place.c_str(), index, rigs->size());
  }
  return VersionedRig{&(*rigs)[static_cast<size_t>(index)], version->get<int>()};
}

Status CheckMesh(const RigJson& rig, const GltfMorphMesh& mesh) {
  if (rig.num_vertices == mesh.num_vertices() && rig.mesh_hash == HashMesh(mesh)) return {};
  return Error(StatusCode::kMeshMismatch,
               "mesh %s: it was changed after the bake (baked with %u vertices and hash %s, "
               "found %u and %s); bake last, after every other tool",
               Quoted(mesh.name).c_str(), rig.num_vertices, Printable(rig.mesh_hash).c_str(),
               mesh.num_vertices(), HashMesh(mesh).c_str());
}

Status ReadWeld(const GltfFile& file, const RigJson& rig, const GltfMorphMesh& mesh,
                SkinMesh* skin) {
  Result<Vector<float>> ids = ReadMeshAttribute(file, mesh, kWeldAttribute, 1);
  if (!ids.ok()) return ids.status();
  for (size_t d = 0; d < ids->size(); ++d) {
    const float id = (*ids)[d];
    if (!(id >= 0) || !(id < static_cast<float>(rig.num_solve_vertices)) || id != std::floor(id)) {
      return Error(StatusCode::kMalformed, "%s: vertex %zu: %g is not a solve vertex below %u",
                   kWeldAttribute, d, static_cast<double>(id), rig.num_solve_vertices);
    }
    skin->solve_vertex.push_back(static_cast<uint32_t>(id));
  }
  return {};
}

// The draw vertex that first uses each solve vertex, whose data stand for it.
Result<Vector<uint32_t>> FirstDrawVertices(const SkinMesh& skin) {
  Vector<uint32_t> first(skin.num_solve_vertices, skin.num_draw_vertices);
  for (uint32_t d = skin.num_draw_vertices; d-- > 0;)
    first[skin.solve_vertex[d]] = d;
  const auto unused = std::find(first.begin(), first.end(), skin.num_draw_vertices);
  if (unused != first.end()) {
    return Error(StatusCode::kMalformed, "%s: no vertex uses solve vertex %td", kWeldAttribute,
                 unused - first.begin());
  }
  return first;
}

Status ReadWeights(const GltfFile& file, const GltfMorphMesh& mesh,
                   const Vector<uint32_t>& first_draw, SkinMesh* skin) {
  constexpr size_t kPerAttribute = 4;
  const auto num_handles = static_cast<size_t>(skin->num_handles);
  if (uint64_t{skin->num_draw_vertices} * num_handles > file.limits().max_weights) {
    return Error(StatusCode::kLimitExceeded, "%s: %u vertices times %zu handles, the limit is %llu",
                 kWeightsAttributePrefix, skin->num_draw_vertices, num_handles,
                 static_cast<unsigned long long>(file.limits().max_weights));
  }
  skin->weights.resize(num_handles * skin->num_solve_vertices);
  for (size_t first = 0; first < num_handles; first += kPerAttribute) {
    const std::string name = kWeightsAttributePrefix + std::to_string(first / kPerAttribute);
    Result<Vector<float>> numbers =
        ReadMeshAttribute(file, mesh, name, static_cast<int>(kPerAttribute));
    if (!numbers.ok()) return numbers.status();
    const size_t used = std::min(kPerAttribute, num_handles - first);
    for (size_t v = 0; v < skin->num_solve_vertices; ++v) {
      const float* row = numbers->data() + kPerAttribute * first_draw[v];
      std::copy(row, row + used,
                skin->weights.begin() + static_cast<ptrdiff_t>(v * num_handles + first));
    }
  }
  return {};
}

// x_rig = basis^T (x_mesh - origin) / scale, in double.
Vec3 ToRigSpace(const RigSpace& space, const Vec3& base, const Vec3& offset) {
  const auto [ox, oy, oz] = space.origin;
  const double from_origin[3] = {double{base.x} + double{offset.x} - double{ox},
                                 double{base.y} + double{offset.y} - double{oy},
                                 double{base.z} + double{offset.z} - double{oz}};
  Vec3 result;
  size_t entry = 0;  // column after column
  for (int column = 0; column < 3; ++column) {
    double sum = 0;
    for (const double x : from_origin)
      sum += double{space.basis[entry++]} * x;
    result[column] = static_cast<float>(sum / double{space.scale});
  }
  return result;
}

Status FillShapes(const GltfLimits& limits, const RigJson& rig, const GltfMorphMesh& mesh,
                  const Vector<uint32_t>& first_draw, SkinMesh* skin) {
  if (!(rig.tables.space.scale > 0)) {
    return Error(StatusCode::kMalformed, "space.scale: it is not positive");
  }
  // Many example shapes may name one morph target: what they ask for is limited, not what is there.
  if (uint64_t{rig.shape_targets.size()} * first_draw.size() > limits.max_morph_positions) {
    return Error(StatusCode::kLimitExceeded, "shapes: %zu times %zu vertices, the limit is %llu",
                 rig.shape_targets.size(), first_draw.size(),
                 static_cast<unsigned long long>(limits.max_morph_positions));
  }
  skin->shape_positions.reserve(rig.shape_targets.size() * first_draw.size());
  for (size_t s = 0; s < rig.shape_targets.size(); ++s) {
    const int target = rig.shape_targets[s];
    if (target >= static_cast<int>(mesh.targets.size())) {
      return Error(StatusCode::kMalformed, "shapes[%zu].target: it is %d, the mesh has %zu targets",
                   s, target, mesh.targets.size());
    }
    for (const uint32_t d : first_draw) {
      const Vec3 offset = target < 0 ? Vec3{} : mesh.targets[static_cast<size_t>(target)][d];
      skin->shape_positions.push_back(ToRigSpace(rig.tables.space, mesh.positions[d], offset));
      // Planar characters have exactly two rig coordinates; what rounding left of the third goes.
      if (rig.tables.dimension == 2) skin->shape_positions.back().z = 0;
    }
  }
  return {};
}

// The rest of the mesh; normals and tangents are computed where the file has none.
void MoveSurface(const RigSpace& space, GltfMorphMesh* mesh, SkinMesh* skin) {
  skin->triangles = std::move(mesh->triangles);
  skin->primitives = std::move(mesh->primitives);
  skin->source_vertex = std::move(mesh->source_vertex);
  skin->num_source_vertices = mesh->num_source_vertices;
  skin->rest_normals = std::move(mesh->normals);
  skin->rest_tangents = std::move(mesh->tangents);
  skin->texcoords = std::move(mesh->texcoords);
  CompleteRestFrames(space.basis, skin);
}

// A node number that another tool has shifted is worth nothing: the name must agree.
void CheckHandleNodes(const GltfFile& file, RigTables* tables) {
  const auto nodes = file.json().find("nodes");
  const size_t num_nodes = nodes == file.json().end() ? 0 : nodes->size();
  for (RigHandle& handle : tables->handles) {
    const bool named = handle.node >= 0 && static_cast<size_t>(handle.node) < num_nodes &&
                       std::string_view(handle.name) ==
                           (*nodes)[static_cast<size_t>(handle.node)].value("name", "");
    if (!named) handle.node = -1;
  }
}

Result<std::shared_ptr<const Rig>> BuildRig(const GltfFile& file, int rig_index) {
  Result<VersionedRig> found = FindRig(file, rig_index);
  if (!found.ok()) return found.status();
  const Json& json = *found->json;
  const std::string place =
      std::string(kRigExtensionName) + ".rigs[" + std::to_string(rig_index) + "]";
  Result<RigJson> rig = ReadRigJson(json, file.limits());
  if (!rig.ok()) return rig.status().WithContext(place);
  const int node = FindRigNode(file, rig_index);
  if (node < 0) {
    return Error(StatusCode::kMeshMismatch,
                 "nodes: none carries rig %d, so a tool has dropped the mark; bake again, last",
                 rig_index);
  }
  const Json& node_json = file.json()["nodes"][static_cast<size_t>(node)];
  Result<GltfMorphMesh> mesh = ReadMorphMesh(file, node_json["mesh"].get<int>());
  if (!mesh.ok()) {
    // The caller puts the file's name in front, and it is there already.
    const std::string& text = mesh.status().message();
    const std::string name = file.name() + ": ";
    return Status(mesh.status().code(), text.substr(text.rfind(name, 0) == 0 ? name.size() : 0));
  }
  LIMBER_RETURN_IF_ERROR(CheckMesh(*rig, *mesh));
  LIMBER_RETURN_IF_ERROR(ReadRigTables(file, found->version, &*rig).WithContext(place));
  SkinMesh skin;
  skin.num_solve_vertices = rig->num_solve_vertices;
  skin.num_draw_vertices = mesh->num_vertices();
  skin.num_handles = rig->tables.num_handles();
  skin.num_shapes = rig->tables.num_shapes();
  LIMBER_RETURN_IF_ERROR(ReadWeld(file, *rig, *mesh, &skin));
  Result<Vector<uint32_t>> first_draw = FirstDrawVertices(skin);
  if (!first_draw.ok()) return first_draw.status();
  LIMBER_RETURN_IF_ERROR(ReadWeights(file, *mesh, *first_draw, &skin));
  LIMBER_RETURN_IF_ERROR(
      FillShapes(file.limits(), *rig, *mesh, *first_draw, &skin).WithContext(place));
  if (rig->shape_targets.front() != -1) {
    // The file's normals are those of the base mesh, which is no example here.
    mesh->normals.clear();
    mesh->tangents.clear();
  }
  MoveSurface(rig->tables.space, &*mesh, &skin);
  CheckHandleNodes(file, &rig->tables);
  const std::string name = json.contains("name") && json["name"].is_string()
                               ? json["name"].get<std::string>()
                               : mesh->name;
  return Rig::Create(name, std::move(rig->tables), std::move(skin));
}

}  // namespace

int CountRigs(const GltfFile& file) {
  const Json* extension = FindExtension(file.json());
  if (extension == nullptr) return 0;
  const auto rigs = extension->find("rigs");
  return rigs == extension->end() || !rigs->is_array() ? 0 : static_cast<int>(rigs->size());
}

int FindRigNode(const GltfFile& file, int rig_index) {
  const auto nodes = file.json().find("nodes");
  if (nodes == file.json().end()) return -1;
  for (size_t n = 0; n < nodes->size(); ++n) {
    const Json* extension = FindExtension((*nodes)[n]);
    if (extension == nullptr || !(*nodes)[n].contains("mesh")) continue;
    const auto rig = extension->find("rig");
    if (rig != extension->end() && rig->is_number_integer() && *rig == rig_index) {
      return static_cast<int>(n);
    }
  }
  return -1;
}

Result<std::shared_ptr<const Rig>> LoadRig(const GltfFile& file, const RigLoadOptions& options) {
  return CatchOutOfMemory(file.name(), [&]() -> Result<std::shared_ptr<const Rig>> {
    Result<std::shared_ptr<const Rig>> rig = BuildRig(file, options.rig_index);
    if (!rig.ok()) return rig.status().WithContext(file.name());
    return rig;
  });
}

Result<std::shared_ptr<const Rig>> LoadRig(const std::filesystem::path& path,
                                           const RigLoadOptions& options) {
  Result<GltfFile> file = GltfFile::Open(path, options.limits);
  if (!file.ok()) return file.status();
  return LoadRig(*file, options);
}

Result<std::shared_ptr<const Rig>> LoadRigFromMemory(std::span<const uint8_t> bytes,
                                                     const std::string& name,
                                                     const RigLoadOptions& options) {
  Result<GltfFile> file = GltfFile::Parse(bytes, name, options.limits);
  if (!file.ok()) return file.status();
  return LoadRig(*file, options);
}

}  // namespace limber
