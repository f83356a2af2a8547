#include "import/import_gltf.h"

#include "clips/node_transforms.h"
#include "core/vector.h"
#include "import/mesh_node.h"
#include "import/vertex_stiffness.h"
#include "load/gltf_mesh.h"

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kHandleMark[] = "limber_handle";

const Json& EmptyArray() {
  static const Json empty = Json::array();
  return empty;
}

const Json& Nodes(const GltfFile& file) {
  const auto nodes = file.json().find("nodes");
  return nodes == file.json().end() ? EmptyArray() : *nodes;
}

bool HasTargets(const GltfFile& file, const Json& node) {
  const auto mesh = node.find("mesh");
  if (mesh == node.end()) return false;
  const Json& primitives = file.json()["meshes"][mesh->get<size_t>()]["primitives"];
  return std::any_of(primitives.begin(), primitives.end(), [](const Json& primitive) {
    const auto targets = primitive.find("targets");
    return targets != primitive.end() && !targets->empty();
  });
}

Result<int> FindMeshNode(const GltfFile& file, const std::string& wanted) {
  if (!wanted.empty()) return FindNamedMeshNode(file, wanted);
  const Vector<size_t> with_mesh = MeshNodes(file);
  Vector<size_t> candidates;
  for (const size_t n : with_mesh) {
    if (HasTargets(file, Nodes(file)[n])) candidates.push_back(n);
  }
  if (candidates.size() == 1) return static_cast<int>(candidates[0]);
  if (candidates.size() > 1) {
    return Status(StatusCode::kInvalidArgument,
                  "nodes: several meshes have morph targets; choose one with --node: " +
                      ListNodes(file, candidates));
  }
  // Reading a mesh without targets explains the usual cause.
  if (!with_mesh.empty()) return static_cast<int>(with_mesh[0]);
  return Error(StatusCode::kNoExamples, "nodes: none of them carries a mesh");
}

void FillShapes(const GltfMorphMesh& mesh, bool include_base, RawCharacter* raw) {
  PointMatrix base(mesh.num_vertices(), 3);
  for (uint32_t v = 0; v < mesh.num_vertices(); ++v) {
    for (int axis = 0; axis < 3; ++axis)
      base(v, axis) = mesh.positions[v][axis];
  }
  if (include_base) {
    raw->shape_names.emplace_back("base");
    raw->shapes.push_back(base);
  }
  for (size_t t = 0; t < mesh.targets.size(); ++t) {
    PointMatrix shape = base;
    for (uint32_t v = 0; v < mesh.num_vertices(); ++v) {
      for (int axis = 0; axis < 3; ++axis)
        shape(v, axis) += double{mesh.targets[t][v][axis]};
    }
    raw->shape_names.push_back(mesh.target_names[t]);
    raw->shapes.push_back(std::move(shape));
  }
}

void FillSurface(GltfMorphMesh* mesh, RawCharacter* raw) {
  raw->triangles = std::move(mesh->triangles);
  raw->primitives = std::move(mesh->primitives);
  raw->source_vertex = std::move(mesh->source_vertex);
  raw->num_source_vertices = mesh->num_source_vertices;
  raw->texcoords = std::move(mesh->texcoords);
  raw->normals = std::move(mesh->normals);
  raw->tangents = std::move(mesh->tangents);
}

// Reads the mark of one node; nullopt: it is no handle.
Result<std::optional<HandleSpec>> ReadMark(const GltfFile& file, size_t n) {
  const Json& nodes = Nodes(file);
  const auto extras = nodes[n].find("extras");
  if (extras == nodes[n].end() || !extras->is_object()) return std::optional<HandleSpec>();
  const auto mark = extras->find(kHandleMark);
  if (mark == extras->end() || (mark->is_boolean() && !mark->get<bool>())) {
    return std::optional<HandleSpec>();
  }
  HandleSpec spec;
  spec.name = NodeName(file, n);
  spec.node = static_cast<int>(n);
  const std::string place = "node \"" + spec.name + "\": extras." + kHandleMark;
  // Blender writes custom properties of tick boxes as true or 1.
  if (mark->is_boolean() || *mark == 1) return std::optional<HandleSpec>(spec);
  if (!mark->is_object()) {
    return Status(StatusCode::kMalformed,
                  place + ": it is " + mark->dump() + "; write true, or {\"pinned\": false}");
  }
  if (const auto pinned = mark->find("pinned"); pinned != mark->end()) {
    if (!pinned->is_boolean()) {
      return Status(StatusCode::kMalformed, place + ".pinned: it is neither true nor false");
    }
    spec.pinned = pinned->get<bool>();
  }
  if (const auto stiffness = mark->find("stiffness"); stiffness != mark->end()) {
    spec.stiffness = stiffness->is_number() ? stiffness->get<double>() : 0;
    if (!IsRegionStiffness(spec.stiffness)) {
      return Status(StatusCode::kMalformed, place + ".stiffness: it is " + stiffness->dump() +
                                                "; write a number from 0.001 to 1000");
    }
  }
  return std::optional<HandleSpec>(spec);
}

Status ReadMarks(const GltfFile& file, RawCharacter* raw) {
  const Json& nodes = Nodes(file);
  Vector<Eigen::Matrix4d> world;
  Eigen::Matrix4d to_mesh = Eigen::Matrix4d::Identity();
  for (size_t n = 0; n < nodes.size(); ++n) {
    Result<std::optional<HandleSpec>> spec = ReadMark(file, n);
    if (!spec.ok()) return spec.status();
    if (!spec->has_value()) continue;
    if (world.empty()) {
      world = WorldTransforms(file);
      const Eigen::Matrix4d& mesh_world = world[static_cast<size_t>(raw->node)];
      to_mesh = mesh_world.inverse();
      if (!to_mesh.allFinite() || mesh_world.topLeftCorner<3, 3>().determinant() == 0) {
        return Status(StatusCode::kMalformed, "node \"" +
                                                  NodeName(file, static_cast<size_t>(raw->node)) +
                                                  "\": its transform has no inverse, so its "
                                                  "handles have no place; give it a scale");
      }
    }
    const Eigen::Vector4d position = to_mesh * world[n].col(3);
    if (!position.allFinite()) {
      return Status(StatusCode::kMalformed,
                    "node \"" + (*spec)->name + "\": its position is not a finite number");
    }
    (*spec)->position = Vec3{static_cast<float>(position.x()), static_cast<float>(position.y()),
                             static_cast<float>(position.z())};
    raw->marked_handles.push_back(**spec);
  }
  return {};
}

}  // namespace

Result<RawCharacter> ImportGltf(const std::filesystem::path& path, const ImportOptions& options) {
  Result<GltfFile> file = GltfFile::Open(path);
  if (!file.ok()) return file.status();
  return ImportGltf(*file, options);
}

Result<RawCharacter> ImportGltf(const GltfFile& file, const ImportOptions& options) {
  const Result<int> node = FindMeshNode(file, options.node);
  if (!node.ok()) return node.status().WithContext(file.name());
  RawCharacter raw;
  raw.file = file.name();
  raw.node = *node;
  const Json& json = Nodes(file)[static_cast<size_t>(raw.node)];
  raw.mesh = json["mesh"].get<int>();
  Result<GltfMorphMesh> mesh = ReadMorphMesh(file, raw.mesh);
  if (!mesh.ok()) return mesh.status();
  Result<Vector<float>> stiffness = ReadVertexStiffness(file, *mesh, options.stiffness);
  if (!stiffness.ok()) return stiffness.status().WithContext(file.name());
  raw.stiffness = std::move(stiffness).value();
  raw.name = json.value("name", "").empty() ? mesh->name : json.value("name", "");
  raw.warnings = std::move(mesh->warnings);
  FillShapes(*mesh, options.include_base, &raw);
  FillSurface(&*mesh, &raw);
  if (!options.include_base) {
    // The file's normals are the base's; the first example shape gets its own, computed.
    raw.normals.clear();
    raw.tangents.clear();
  }
  LIMBER_RETURN_IF_ERROR(ReadMarks(file, &raw).WithContext(file.name()));
  return raw;
}

}  // namespace limber::bake
