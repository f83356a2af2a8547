#include "load/gltf_mesh.h"

#include "core/out_of_memory.h"
#include "core/printable.h"
#include "core/vector.h"
#include "load/gltf_accessor.h"
#include "load/smooth_normals.h"
#include "rig/rig_fields.h"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <cinttypes>
#include <cstring>
#include <numeric>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

std::string PrimitivePlace(int mesh, size_t primitive) {
  return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
}

int FindAttribute(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto it = attributes.find(name);
  return it == attributes.end() ? -1 : it->second;
}

bool MakesTriangles(int mode) {
  return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
         mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

Vec3 At(const Vector<float>& numbers, size_t i) {
  return {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

// Corners of a list, strip or fan -> corners of triangles. Strips are sewn together with triangles
// that repeat a corner: those are dropped, while a list keeps its own degenerate triangles.
void AppendTriangles(const Vector<uint32_t>& corners, int mode, uint32_t first_vertex,
                     Vector<uint32_t>* triangles) {
  const size_t num_corners = corners.size();
  const auto append = [&](size_t a, size_t b, size_t c) {
    for (const size_t corner : {a, b, c})
      triangles->push_back(first_vertex + corners[corner]);
  };
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    for (size_t i = 0; i + 3 <= num_corners; i += 3)
      append(i, i + 1, i + 2);
    return;
  }
  for (size_t i = 0; i + 3 <= num_corners; ++i) {
    const size_t a = mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i;
    const bool flipped = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
    const size_t b = i + (flipped ? 2 : 1), c = i + (flipped ? 1 : 2);
    if (corners[a] != corners[b] && corners[b] != corners[c] && corners[a] != corners[c]) {
      append(a, b, c);
    }
  }
}

// Reads one mesh; each step appends one kind of data of one primitive.
class MeshReader {
 public:
  MeshReader(const GltfFile& file, int index)
      : file_(file),
        source_(file.model().meshes[static_cast<size_t>(index)]) {
    mesh_.mesh = index;
    mesh_.name = source_.name.empty() ? "mesh " + std::to_string(index) : source_.name;
  }

  Result<GltfMorphMesh> Read() {
    LIMBER_RETURN_IF_ERROR(CountTargets());
    LIMBER_RETURN_IF_ERROR(CountVertices());
    for (size_t p = 0; p < source_.primitives.size(); ++p) {
      if (Skipped(p)) continue;
      LIMBER_RETURN_IF_ERROR(AppendPrimitive(p));
    }
    CompleteSurface();
    ReadTargetNames();
    LIMBER_RETURN_IF_ERROR(ReadSourceOrder());
    return std::move(mesh_);
  }

 private:
  bool Skipped(size_t p) const { return !MakesTriangles(source_.primitives[p].mode); }

  Status CountTargets() {
    size_t num_targets = 0, first_with_targets = 0;
    for (size_t p = 0; p < source_.primitives.size(); ++p) {
      const size_t here = source_.primitives[p].targets.size();
      if (Skipped(p) || here == 0) continue;
      if (num_targets == 0) {
        num_targets = here;
        first_with_targets = p;
      } else if (here != num_targets) {
        return Error(StatusCode::kMalformed,
                     "%s: %zu morph targets, and primitive %zu has %zu; all primitives of a mesh "
                     "need the same targets, export it again",
                     PrimitivePlace(mesh_.mesh, p).c_str(), here, first_with_targets, num_targets);
      }
    }
    if (num_targets == 0) {
      return Error(
          StatusCode::kNoExamples,
          "mesh %s: it has no morph target, and example shapes are what Limber poses "
          "from; if it has shape keys in Blender, the exporter's \"Apply Modifiers\" drops "
          "them: switch that off (or apply the modifiers first) and export again",
          Quoted(mesh_.name).c_str());
    }
    if (num_targets > file_.limits().max_targets) {
      return Error(StatusCode::kLimitExceeded, "mesh %s: %zu morph targets, the limit is %llu",
                   Quoted(mesh_.name).c_str(), num_targets,
                   static_cast<unsigned long long>(file_.limits().max_targets));
    }
    mesh_.targets.resize(num_targets);
    return {};
  }

  Status CountVertices() {
    uint64_t total = 0;
    for (size_t p = 0; p < source_.primitives.size(); ++p) {
      if (Skipped(p)) {
        mesh_.warnings.push_back(PrimitivePlace(mesh_.mesh, p) +
                                 ": points and lines are left out; only triangles are deformed");
        continue;
      }
      const int position = FindAttribute(source_.primitives[p].attributes, "POSITION");
      if (position < 0) {
        return Error(StatusCode::kMalformed, "%s: it has no POSITION",
                     PrimitivePlace(mesh_.mesh, p).c_str());
      }
      total += static_cast<uint64_t>(AccessorCount(file_, position));
    }
    if (total > file_.limits().max_vertices ||
        total * mesh_.targets.size() > file_.limits().max_morph_positions) {
      return Error(StatusCode::kLimitExceeded,
                   "mesh %s: %llu vertices with %zu morph targets are more than the limits "
                   "allow (%llu vertices, %llu vertices times targets)",
                   Quoted(mesh_.name).c_str(), static_cast<unsigned long long>(total),
                   mesh_.targets.size(),
                   static_cast<unsigned long long>(file_.limits().max_vertices),
                   static_cast<unsigned long long>(file_.limits().max_morph_positions));
    }
    return {};
  }

  Status AppendPrimitive(size_t p) {
    const tinygltf::Primitive& source = source_.primitives[p];
    SkinPrimitive primitive;
    primitive.first_vertex = mesh_.num_vertices();
    primitive.first_triangle = static_cast<uint32_t>(mesh_.triangles.size() / 3);
    primitive.gltf_primitive = static_cast<int32_t>(p);
    primitive.material = source.material;
    AccessorRequest request{FindAttribute(source.attributes, "POSITION"), 3,
                            PrimitivePlace(mesh_.mesh, p) + ".POSITION"};
    Result<Vector<float>> positions = ReadFloats(file_, request);
    if (!positions.ok()) return positions.status();
    primitive.num_vertices = static_cast<uint32_t>(positions->size() / 3);
    for (size_t v = 0; v < primitive.num_vertices; ++v)
      mesh_.positions.push_back(At(*positions, v));
    LIMBER_RETURN_IF_ERROR(AppendTargets(source, p, primitive.num_vertices));
    LIMBER_RETURN_IF_ERROR(AppendIndices(source, p, primitive));
    primitive.num_triangles =
        static_cast<uint32_t>(mesh_.triangles.size() / 3) - primitive.first_triangle;
    mesh_.primitives.push_back(primitive);
    return AppendSurface(source, p, primitive);
  }

  // A primitive without targets beside one with them, and a target without POSITION, stay at rest.
  Status AppendTargets(const tinygltf::Primitive& source, size_t p, uint32_t count) {
    for (size_t t = 0; t < mesh_.targets.size(); ++t) {
      Vector<Vec3>& offsets = mesh_.targets[t];
      const int accessor =
          source.targets.empty() ? -1 : FindAttribute(source.targets[t], "POSITION");
      if (accessor < 0) {
        offsets.resize(offsets.size() + count);
        continue;
      }
      AccessorRequest request{
          accessor, 3,
          PrimitivePlace(mesh_.mesh, p) + ".targets[" + std::to_string(t) + "].POSITION"};
      request.expected_count = count;
      request.may_be_implicit = true;
      Result<Vector<float>> numbers = ReadFloats(file_, request);
      if (!numbers.ok()) return numbers.status();
      for (size_t v = 0; v < count; ++v)
        offsets.push_back(At(*numbers, v));
    }
    return {};
  }

  Status AppendIndices(const tinygltf::Primitive& source, size_t p,
                       const SkinPrimitive& primitive) {
    const auto num_corners =
        source.indices < 0 ? int64_t{primitive.num_vertices} : AccessorCount(file_, source.indices);
    // Of a strip or fan every corner after the second makes a triangle.
    const auto added = static_cast<uint64_t>(
        source.mode == TINYGLTF_MODE_TRIANGLES ? num_corners / 3 : num_corners - 2);
    if (num_corners > 2 && mesh_.triangles.size() / 3 + added > file_.limits().max_triangles) {
      return Error(StatusCode::kLimitExceeded, "%s: more than %llu triangles",
                   PrimitivePlace(mesh_.mesh, p).c_str(),
                   static_cast<unsigned long long>(file_.limits().max_triangles));
    }
    Vector<uint32_t> corners;
    if (source.indices < 0) {
      corners.resize(primitive.num_vertices);
      std::iota(corners.begin(), corners.end(), 0u);
    } else {
      AccessorRequest request{source.indices, 1, PrimitivePlace(mesh_.mesh, p) + ".indices"};
      Result<Vector<uint32_t>> indices = ReadIndices(file_, request, primitive.num_vertices);
      if (!indices.ok()) return indices.status();
      corners = std::move(*indices);
    }
    if (source.mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
      return Error(StatusCode::kMalformed, "%s: %zu corners are not whole triangles",
                   PrimitivePlace(mesh_.mesh, p).c_str(), corners.size());
    }
    AppendTriangles(corners, source.mode, primitive.first_vertex, &mesh_.triangles);
    return {};
  }

  // Normals, tangents and texture coordinates, zeros before and after where a primitive has none.
  Status AppendSurface(const tinygltf::Primitive& source, size_t p,
                       const SkinPrimitive& primitive) {
    Vector<float> normals;
    LIMBER_RETURN_IF_ERROR(ReadOptional(source, p, "NORMAL", 3, primitive, &normals));
    LIMBER_RETURN_IF_ERROR(ReadOptional(source, p, "TANGENT", 4, primitive, &mesh_.tangents));
    LIMBER_RETURN_IF_ERROR(ReadOptional(source, p, "TEXCOORD_0", 2, primitive, &mesh_.texcoords));
    if (!normals.empty() || !mesh_.normals.empty()) mesh_.normals.resize(mesh_.positions.size());
    for (size_t v = 0; v < primitive.num_vertices && !normals.empty(); ++v) {
      mesh_.normals[primitive.first_vertex + v] = At(normals, primitive.first_vertex + v);
    }
    return {};
  }

  Status ReadOptional(const tinygltf::Primitive& source, size_t p, const char* name, int components,
                      const SkinPrimitive& primitive, Vector<float>* numbers) {
    const size_t wanted = mesh_.positions.size() * static_cast<size_t>(components);
    const int accessor = FindAttribute(source.attributes, name);
    if (accessor < 0) {
      if (!numbers->empty()) numbers->resize(wanted);
      return {};
    }
    AccessorRequest request{accessor, components, PrimitivePlace(mesh_.mesh, p) + "." + name};
    request.expected_count = primitive.num_vertices;
    Result<Vector<float>> read = ReadFloats(file_, request);
    if (!read.ok()) return read.status();
    numbers->resize(primitive.first_vertex * static_cast<size_t>(components));
    numbers->insert(numbers->end(), read->begin(), read->end());
    return {};
  }

  // Normals and tangents are wanted for all vertices or for none.
  void CompleteSurface() {
    if (!mesh_.normals.empty()) {
      Vector<uint32_t> unshared(mesh_.positions.size());
      std::iota(unshared.begin(), unshared.end(), 0u);
      CompleteNormals(mesh_.positions, unshared, mesh_.triangles, &mesh_.normals);
    }
    for (size_t v = 0; 4 * v < mesh_.tangents.size(); ++v) {
      const float* tangent = mesh_.tangents.data() + 4 * v;
      if (tangent[0] == 0 && tangent[1] == 0 && tangent[2] == 0) {
        mesh_.tangents.clear();
      }
    }
  }

  void ReadTargetNames() {
    const Json& json = file_.json()["meshes"][static_cast<size_t>(mesh_.mesh)];
    const Json* names = nullptr;
    if (const auto extras = json.find("extras"); extras != json.end() && extras->is_object()) {
      if (const auto it = extras->find("targetNames"); it != extras->end() && it->is_array()) {
        names = &*it;
      }
    }
    for (size_t t = 0; t < mesh_.targets.size(); ++t) {
      const bool named = names != nullptr && t < names->size() && (*names)[t].is_string();
      mesh_.target_names.push_back(named ? (*names)[t].get<std::string>()
                                         : "target_" + std::to_string(t));
    }
  }

  Status ReadSourceOrder() {
    const uint32_t count = mesh_.num_vertices();
    Result<Vector<float>> ids = ReadMeshAttribute(file_, mesh_, kSourceAttribute, 1);
    if (!ids.ok() && ids.status().code() == StatusCode::kNotFound) {
      mesh_.source_vertex.resize(count);
      std::iota(mesh_.source_vertex.begin(), mesh_.source_vertex.end(), 0u);
      mesh_.num_source_vertices = count;
      return {};
    }
    if (!ids.ok()) return ids.status();
    for (size_t v = 0; v < count; ++v) {
      const float id = (*ids)[v];
      if (!(id >= 0) || id >= static_cast<float>(count) ||
          id != static_cast<float>(static_cast<uint32_t>(id))) {
        return Error(StatusCode::kMalformed, "%s: vertex %zu: %g is not a vertex number below %u",
                     kSourceAttribute, v, static_cast<double>(id), count);
      }
      mesh_.source_vertex.push_back(static_cast<uint32_t>(id));
      mesh_.num_source_vertices =
          std::max(mesh_.num_source_vertices, mesh_.source_vertex.back() + 1);
    }
    return {};
  }

  const GltfFile& file_;
  const tinygltf::Mesh& source_;
  GltfMorphMesh mesh_;
};

class Fnv1a {
 public:
  void Add(const void* data, size_t size) {
    const auto* bytes = static_cast<const uint8_t*>(data);
    for (size_t i = 0; i < size; ++i)
      hash_ = (hash_ ^ bytes[i]) * 0x100000001B3ull;
  }

  void AddCount(uint32_t count) { Add(&count, sizeof(count)); }

  void AddPositions(const Vector<Vec3>& positions) {
    // Zero has two signs, and tools may change it; adding positive zero leaves only one.
    for (const Vec3& p : positions) {
      const Vec3 canonical{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
      Add(&canonical, sizeof(canonical));
    }
  }

  uint64_t hash() const { return hash_; }

 private:
  uint64_t hash_ = 0xCBF29CE484222325ull;
};

}  // namespace

Result<GltfMorphMesh> ReadMorphMesh(const GltfFile& file, int mesh) {
  if (mesh < 0 || static_cast<size_t>(mesh) >= file.model().meshes.size()) {
    return Error(StatusCode::kInvalidArgument, "%s: meshes[%d]: there is no such mesh",
                 file.name().c_str(), mesh);
  }
  return CatchOutOfMemory(file.name(), [&]() -> Result<GltfMorphMesh> {
    Result<GltfMorphMesh> result = MeshReader(file, mesh).Read();
    if (!result.ok()) return result.status().WithContext(file.name());
    return result;
  });
}

Result<Vector<float>> ReadMeshAttribute(const GltfFile& file, const GltfMorphMesh& mesh,
                                        const std::string& attribute, int components) {
  return CatchOutOfMemory(attribute, [&]() -> Result<Vector<float>> {
    const tinygltf::Mesh& source = file.model().meshes[static_cast<size_t>(mesh.mesh)];
    Vector<float> all;
    for (const SkinPrimitive& primitive : mesh.primitives) {
      const auto p = static_cast<size_t>(primitive.gltf_primitive);
      const std::string place = PrimitivePlace(mesh.mesh, p) + "." + attribute;
      AccessorRequest request{FindAttribute(source.primitives[p].attributes, attribute), components,
                              place};
      if (request.accessor < 0) return Status(StatusCode::kNotFound, place + ": it is missing");
      request.expected_count = primitive.num_vertices;
      Result<Vector<float>> numbers = ReadFloats(file, request);
      if (!numbers.ok()) return numbers.status();
      all.insert(all.end(), numbers->begin(), numbers->end());
    }
    return all;
  });
}

std::string HashMesh(const GltfMorphMesh& mesh) {
  Fnv1a hash;
  hash.AddCount(mesh.num_vertices());
  hash.AddCount(static_cast<uint32_t>(mesh.triangles.size()));
  hash.AddCount(static_cast<uint32_t>(mesh.targets.size()));
  hash.Add(mesh.triangles.data(), mesh.triangles.size() * sizeof(uint32_t));
  hash.AddPositions(mesh.positions);
  for (const Vector<Vec3>& target : mesh.targets)
    hash.AddPositions(target);
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, hash.hash());
  return text;
}

}  // namespace limber
