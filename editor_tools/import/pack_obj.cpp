#include "import/pack_obj.h"

#include "core/vec3.h"
#include "core/vector.h"
#include "import/file_output.h"
#include "import/source_faces.h"
#include "load/smooth_normals.h"
#include "rig/rig_fields.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <numeric>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;

// For each entry the first one of the same value, so that files that repeat a normal or texture
// coordinate at every corner do not split every vertex.
template <size_t N>
Vector<int32_t> FirstOfValue(const Vector<std::array<float, N>>& items) {
  std::map<std::array<float, N>, int32_t> first;
  Vector<int32_t> result;
  result.reserve(items.size());
  for (const auto& item : items) {
    result.push_back(first.emplace(item, static_cast<int32_t>(result.size())).first->second);
  }
  return result;
}

// Draw vertices: one for each (position, texture coordinate, normal) that a corner uses, in the
// order of the source's vertices; vertices that no face uses are kept, so that all come back.
struct DrawVertices {
  Vector<ObjCorner> vertices;
  Vector<uint32_t> of_corner;  // corner of a face -> draw vertex
};

DrawVertices SplitVertices(const ObjMesh& mesh) {
  const Vector<int32_t> texcoord = FirstOfValue(mesh.texcoords);
  const Vector<int32_t> normal = FirstOfValue(mesh.normals);
  Vector<Vector<ObjCorner>> kinds(mesh.positions.size());
  Vector<uint32_t> kind_of_corner;
  for (ObjCorner corner : mesh.corners) {
    if (corner.texcoord >= 0) corner.texcoord = texcoord[static_cast<size_t>(corner.texcoord)];
    if (corner.normal >= 0) corner.normal = normal[static_cast<size_t>(corner.normal)];
    Vector<ObjCorner>& known = kinds[corner.position];
    const auto same = std::find_if(known.begin(), known.end(), [&corner](const ObjCorner& other) {
      return other.texcoord == corner.texcoord && other.normal == corner.normal;
    });
    kind_of_corner.push_back(static_cast<uint32_t>(same - known.begin()));
    if (same == known.end()) known.push_back(corner);
  }
  DrawVertices draw;
  Vector<uint32_t> first_of_position;
  for (uint32_t p = 0; p < kinds.size(); ++p) {
    first_of_position.push_back(static_cast<uint32_t>(draw.vertices.size()));
    if (kinds[p].empty()) kinds[p].push_back({p, -1, -1});
    draw.vertices.insert(draw.vertices.end(), kinds[p].begin(), kinds[p].end());
  }
  for (size_t c = 0; c < mesh.corners.size(); ++c) {
    draw.of_corner.push_back(first_of_position[mesh.corners[c].position] + kind_of_corner[c]);
  }
  return draw;
}

// Collects accessors of one GLB; each has a bufferView of its own.
class GlbBuilder {
 public:
  size_t AddFloats(const Vector<float>& numbers, size_t components, bool with_bounds) {
    static constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3"};
    Json accessor = {{"bufferView", AddView(numbers.data(), 4 * numbers.size(), kArrayBuffer)},
                     {"componentType", kFloat},
                     {"count", numbers.size() / components},
                     {"type", kTypes[components]}};
    if (with_bounds) {
      Vector<float> low(numbers.begin(), numbers.begin() + static_cast<ptrdiff_t>(components));
      Vector<float> high = low;
      for (size_t i = 0; i < numbers.size(); ++i) {
        low[i % components] = std::min(low[i % components], numbers[i]);
        high[i % components] = std::max(high[i % components], numbers[i]);
      }
      accessor["min"] = low;
      accessor["max"] = high;
    }
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  size_t AddIndices(const Vector<uint32_t>& indices, size_t num_vertices) {
    // The largest 16-bit number is reserved (primitive restart).
    const bool narrow = num_vertices < 65536;
    const Vector<uint16_t> narrowed(indices.begin(), narrow ? indices.end() : indices.begin());
    const size_t view = narrow ? AddView(narrowed.data(), 2 * narrowed.size(), kElementArrayBuffer)
                               : AddView(indices.data(), 4 * indices.size(), kElementArrayBuffer);
    accessors_.push_back({{"bufferView", view},
                          {"componentType", narrow ? kUnsignedShort : kUnsignedInt},
                          {"count", indices.size()},
                          {"type", "SCALAR"}});
    return accessors_.size() - 1;
  }

  Result<Vector<uint8_t>> Finish(const std::string& name, const Json& primitive,
                                 const Json& extras) const {
    const Json root = {
        {"asset", {{"version", "2.0"}, {"generator", "limber pack"}}},
        {"scene", 0},
        {"scenes", Json::array({{{"nodes", {0}}}})},
        {"nodes", Json::array({{{"name", name}, {"mesh", 0}}})},
        {"meshes",
         Json::array(
             {{{"name", name}, {"primitives", Json::array({primitive})}, {"extras", extras}}})},
        {"accessors", accessors_},
        {"bufferViews", views_},
        {"buffers", Json::array({{{"byteLength", bin_.size()}}})}};
    try {
      return AssembleGlb(root.dump(), bin_);
    } catch (const std::exception&) {
      return Error(StatusCode::kInvalidArgument, "a name is not UTF-8; rename the file");
    }
  }

 private:
  size_t AddView(const void* data, size_t size, int target) {
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", size}, {"target", target}});
    const auto* bytes = static_cast<const uint8_t*>(data);
    bin_.insert(bin_.end(), bytes, bytes + size);
    bin_.resize((bin_.size() + 3) / 4 * 4, 0);
    return views_.size() - 1;
  }

  Vector<uint8_t> bin_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

// The float that stands in the file, minus zero's sign.
float Stored(double number) {
  return static_cast<float>(number) + 0.0f;
}

Vector<float> BasePositions(const ObjMesh& base, const DrawVertices& draw) {
  Vector<float> numbers;
  for (const ObjCorner& vertex : draw.vertices) {
    for (const double x : base.positions[vertex.position])
      numbers.push_back(Stored(x));
  }
  return numbers;
}

// Offsets from what the base is in the file, so that base plus offset is the shape.
Vector<float> TargetOffsets(const Vector<float>& base, const ObjMesh& shape,
                            const DrawVertices& draw) {
  Vector<float> numbers;
  for (const ObjCorner& vertex : draw.vertices) {
    for (const double x : shape.positions[vertex.position]) {
      numbers.push_back(Stored(x - double{base[numbers.size()]}));
    }
  }
  return numbers;
}

Vector<float> BaseNormals(const ObjMesh& base, const DrawVertices& draw,
                          const Vector<float>& positions, const Vector<uint32_t>& triangles) {
  Vector<Vec3> points, normals;
  // Smooth across texture seams: by the first draw vertex of a position.
  Vector<uint32_t> shared;
  for (uint32_t v = 0; v < draw.vertices.size(); ++v) {
    const ObjCorner& vertex = draw.vertices[v];
    const float* p = positions.data() + 3 * size_t{v};
    points.push_back({p[0], p[1], p[2]});
    const bool repeats = v > 0 && draw.vertices[v - 1].position == vertex.position;
    shared.push_back(repeats ? shared.back() : v);
    Vec3 normal;
    if (vertex.normal >= 0) {
      const auto& n = base.normals[static_cast<size_t>(vertex.normal)];
      normal = {n[0], n[1], n[2]};
    }
    normals.push_back(normal);
  }
  CompleteNormals(points, shared, triangles, &normals);
  Vector<float> numbers;
  for (const Vec3& n : normals)
    numbers.insert(numbers.end(), {n.x, n.y, n.z});
  return numbers;
}

// glTF's v grows downwards. Empty where the base has none at all.
Vector<float> BaseTexcoords(const ObjMesh& base, const DrawVertices& draw) {
  Vector<float> numbers;
  for (const ObjCorner& vertex : draw.vertices) {
    const bool has = vertex.texcoord >= 0;
    const auto uv =
        has ? base.texcoords[static_cast<size_t>(vertex.texcoord)] : std::array<float, 2>{0, 1};
    numbers.insert(numbers.end(), {uv[0], 1 - uv[1]});
  }
  const bool any = std::any_of(draw.vertices.begin(), draw.vertices.end(),
                               [](const ObjCorner& vertex) { return vertex.texcoord >= 0; });
  return any ? numbers : Vector<float>();
}

Status CheckSameTopology(const ObjMesh& base, const ObjMesh& shape) {
  const auto differs = [&](const char* what, size_t base_count, size_t shape_count) {
    return Error(
        StatusCode::kInvalidArgument,
        "%s: %zu %s, and %s has %zu; all shapes need the vertices and faces of the base in "
        "the same order (export them with the same settings)",
        shape.file.c_str(), shape_count, what, base.file.c_str(), base_count);
  };
  if (shape.positions.size() != base.positions.size()) {
    return differs("vertices", base.positions.size(), shape.positions.size());
  }
  if (shape.face_sizes.size() != base.face_sizes.size()) {
    return differs("faces", base.face_sizes.size(), shape.face_sizes.size());
  }
  size_t corner = 0;
  for (size_t f = 0; f < base.face_sizes.size(); ++f) {
    bool same = shape.face_sizes[f] == base.face_sizes[f];
    for (uint32_t i = 0; same && i < base.face_sizes[f]; ++i, ++corner) {
      same = shape.corners[corner].position == base.corners[corner].position;
    }
    if (!same) {
      return Error(
          StatusCode::kInvalidArgument,
          "%s: face %zu (from 0) joins other vertices than in %s; all %zu vertices and %zu "
          "faces need the same order in both",
          shape.file.c_str(), f, base.file.c_str(), base.positions.size(), base.face_sizes.size());
    }
  }
  return {};
}

}  // namespace

Result<Vector<uint8_t>> PackMeshes(const ObjMesh& base, std::span<const ObjMesh> shapes,
                                   std::span<const std::string> shape_names,
                                   const std::string& name) {
  if (shapes.empty()) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: no example shape beside the base; name at least one OBJ more",
                 base.file.c_str());
  }
  for (const ObjMesh& shape : shapes)
    LIMBER_RETURN_IF_ERROR(CheckSameTopology(base, shape));
  const DrawVertices draw = SplitVertices(base);
  if (draw.vertices.size() > GltfLimits().max_vertices) {
    return Error(StatusCode::kLimitExceeded, "%s: %zu vertices after splitting at seams",
                 base.file.c_str(), draw.vertices.size());
  }
  const FanTriangles fans = CutIntoFans(base);
  Vector<uint32_t> triangles;
  for (const uint32_t corner : fans.corners)
    triangles.push_back(draw.of_corner[corner]);
  const Vector<float> positions = BasePositions(base, draw);
  Vector<float> source;
  for (const ObjCorner& vertex : draw.vertices)
    source.push_back(static_cast<float>(vertex.position));

  GlbBuilder builder;
  Json attributes = {
      {"POSITION", builder.AddFloats(positions, 3, true)},
      {"NORMAL", builder.AddFloats(BaseNormals(base, draw, positions, triangles), 3, false)}};
  if (const Vector<float> texcoords = BaseTexcoords(base, draw); !texcoords.empty()) {
    attributes["TEXCOORD_0"] = builder.AddFloats(texcoords, 2, false);
  }
  attributes[kSourceAttribute] = builder.AddFloats(source, 1, false);
  Json targets = Json::array();
  for (const ObjMesh& shape : shapes) {
    targets.push_back(
        {{"POSITION", builder.AddFloats(TargetOffsets(positions, shape, draw), 3, true)}});
  }
  const Json primitive = {{"attributes", attributes},
                          {"indices", builder.AddIndices(triangles, draw.vertices.size())},
                          {"targets", targets}};
  Json extras = DescribeFaces(base, fans);
  if (extras.is_null()) extras = Json::object();
  extras["targetNames"] = Vector<std::string>(shape_names.begin(), shape_names.end());
  return builder.Finish(name, primitive, extras);
}

Status PackObj(const std::filesystem::path& base, std::span<const std::filesystem::path> shapes,
               const PackOptions& options, const std::filesystem::path& output) {
  Result<ObjMesh> base_mesh = ReadObj(base);
  if (!base_mesh.ok()) return base_mesh.status();
  Vector<ObjMesh> meshes;
  Vector<std::string> names;
  for (const std::filesystem::path& path : shapes) {
    Result<ObjMesh> mesh = ReadObj(path);
    if (!mesh.ok()) return mesh.status();
    LIMBER_RETURN_IF_ERROR(CheckSameTopology(*base_mesh, *mesh));
    meshes.push_back(std::move(*mesh));
    names.push_back(path.stem().string());
  }
  const std::string name = options.name.empty() ? base.stem().string() : options.name;
  Result<Vector<uint8_t>> bytes = PackMeshes(*base_mesh, meshes, names, name);
  if (!bytes.ok()) return bytes.status();
  return WriteFileAtomically(output, *bytes);
}

}  // namespace limber::bake
