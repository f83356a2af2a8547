#include "editor_tools/write/synthetic_bake.h"

#include "core/vector.h"
#include "import/file_output.h"
#include "load/glb_container.h"
#include "rig/rest_frames.h"
#include "rig/rig_fields.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <random>

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

// A white PNG of one pixel.
constexpr uint8_t kPng[] = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D,
                            0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01,
                            0x08, 0x00, 0x00, 0x00, 0x00, 0x3A, 0x7E, 0x9B, 0x55, 0x00, 0x00, 0x00,
                            0x0A, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9C, 0x63, 0xF8, 0x0F, 0x00, 0x01,
                            0x01, 0x01, 0x00, 0x1B, 0xB6, 0xEE, 0x56, 0x00, 0x00, 0x00, 0x00, 0x49,
                            0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};

class BufferBuilder {
 public:
  // Returns the bufferView.
  int Add(const void* data, size_t size, int target) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    Json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}};
    if (target != 0) view["target"] = target;
    views.push_back(view);
    const auto* begin = static_cast<const uint8_t*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
    return static_cast<int>(views.size()) - 1;
  }

  int AddFloats(const Vector<float>& numbers, const char* type, int components, bool with_bounds,
                int target = 34962) {
    const auto c = static_cast<size_t>(components);
    Json accessor = {{"bufferView", Add(numbers.data(), 4 * numbers.size(), target)},
                     {"componentType", 5126},
                     {"count", numbers.size() / c},
                     {"type", type}};
    if (with_bounds) {
      Vector<float> low(numbers.begin(), numbers.begin() + components), high = low;
      for (size_t i = 0; i < numbers.size(); ++i) {
        low[i % c] = std::min(low[i % c], numbers[i]);
        high[i % c] = std::max(high[i % c], numbers[i]);
      }
      accessor["min"] = low;
      accessor["max"] = high;
    }
    accessors.push_back(accessor);
    return static_cast<int>(accessors.size()) - 1;
  }

  Vector<uint8_t> bytes;
  Json views = Json::array(), accessors = Json::array();
};

// Two squares side by side, cut at x = 1: the second primitive repeats the seam's vertices.
struct Geometry {
  Vector<float> left = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  Vector<float> right = {1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 0, 0, 2, 1, 0, 1, 1, 0};
  Vector<uint16_t> left_indices = {0, 1, 2, 0, 2, 3};

  static Vector<float> Bend(const Vector<float>& base, float amount) {
    Vector<float> offsets(base.size());
    for (size_t i = 0; i < base.size(); i += 3)
      offsets[i + 2] = amount * base[i] * base[i];
    return offsets;
  }

  static Vector<float> Normals(size_t count) {
    Vector<float> normals(3 * count);
    for (size_t v = 0; v < count; ++v)
      normals[3 * v + 2] = 1;
    return normals;
  }
};

Json MakePrimitives(BufferBuilder* buffer) {
  const Geometry geometry;
  Json primitives = Json::array();
  for (const Vector<float>& base : {geometry.left, geometry.right}) {
    Json attributes = {
        {"POSITION", buffer->AddFloats(base, "VEC3", 3, true)},
        {"NORMAL", buffer->AddFloats(Geometry::Normals(base.size() / 3), "VEC3", 3, false)}};
    Json targets = Json::array();
    for (const float amount : {0.5f, -0.25f}) {
      targets.push_back(
          {{"POSITION", buffer->AddFloats(Geometry::Bend(base, amount), "VEC3", 3, true)}});
    }
    primitives.push_back({{"attributes", attributes}, {"targets", targets}});
  }
  const int view = buffer->Add(geometry.left_indices.data(), 12, 34963);
  buffer->accessors.push_back(
      {{"bufferView", view}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
  primitives[0]["indices"] = buffer->accessors.size() - 1;
  return primitives;
}

void WriteAll(const std::filesystem::path& path, const void* data, size_t size) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

Vector<float> RandomNumbers(int64_t count, std::mt19937* random) {
  Vector<float> numbers(static_cast<size_t>(count));
  for (float& x : numbers)
    x = static_cast<float>((*random)()) / 4.294967296e9f - 0.5f;
  return numbers;
}

void Weld(const bake::RawCharacter& raw, SkinMesh* mesh) {
  std::map<Vector<double>, uint32_t> known;
  for (int d = 0; d < raw.num_draw_vertices(); ++d) {
    Vector<double> key;
    for (const bake::PointMatrix& shape : raw.shapes) {
      key.insert(key.end(), {shape(d, 0), shape(d, 1), shape(d, 2)});
    }
    mesh->solve_vertex.push_back(
        known.emplace(key, static_cast<uint32_t>(known.size())).first->second);
  }
  mesh->num_solve_vertices = static_cast<uint32_t>(known.size());
  mesh->num_draw_vertices = static_cast<uint32_t>(raw.num_draw_vertices());
}

void FillShapes(const bake::RawCharacter& raw, const RigSpace& space, SkinMesh* mesh) {
  for (const bake::PointMatrix& shape : raw.shapes) {
    Vector<Vec3> points(mesh->num_solve_vertices);
    for (int d = raw.num_draw_vertices(); d-- > 0;) {
      Vec3& p = points[mesh->solve_vertex[static_cast<size_t>(d)]];
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] =
            static_cast<float>((shape(d, axis) - double{space.origin[static_cast<size_t>(axis)]}) /
                               double{space.scale});
      }
    }
    mesh->shape_positions.insert(mesh->shape_positions.end(), points.begin(), points.end());
  }
}

void FillHandles(const bake::RawCharacter& raw, int count, const SkinMesh& mesh,
                 RigTables* tables) {
  for (int h = 0; h < count; ++h) {
    RigHandle handle;
    const auto marked = static_cast<size_t>(h);
    const bool is_marked = marked < raw.marked_handles.size();
    handle.name = is_marked ? raw.marked_handles[marked].name : "handle " + std::to_string(h);
    handle.pinned = is_marked ? raw.marked_handles[marked].pinned : h % 3 != 1;
    handle.node = is_marked ? raw.marked_handles[marked].node : -1;
    handle.vertex = static_cast<uint32_t>(h) % mesh.num_solve_vertices;
    handle.rest_position = {0.1f * static_cast<float>(h), 1.0f / 3, -2.5f};
    tables->handles.push_back(handle);
  }
}

}  // namespace

std::filesystem::path WriteRichSource(const std::filesystem::path& folder) {
  BufferBuilder buffer;
  Json root = Json::parse(R"({
    "asset": {"version": "2.0", "generator": "test", "extras": {"nothing": null, "empty": {}}},
    "extensionsUsed": ["VENDOR_thing", "KHR_texture_transform"],
    "scene": 0,
    "scenes": [{"name": "all", "nodes": [1, 4], "extras": {"list": [], "deep": {"a": [null, {}]}}}],
    "nodes": [
      {"name": "sheet", "mesh": 0, "scale": [2, 2, 2], "weights": [0.25, 0],
       "extensions": {"VENDOR_thing": {"x": null}}},
      {"name": "root", "children": [0, 2], "translation": [10, 0, 0],
       "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476]},
      {"name": "tip", "translation": [4, 2, 0], "extras": {"limber_handle": {"pinned": false}, "k": 7}},
      {"name": "bone"},
      {"name": "skinned", "mesh": 1, "skin": 0, "children": [3]}],
    "meshes": [
      {"name": "sheet mesh", "extras": {"targetNames": ["bend", "lift"], "big": 12345678901234}},
      {"name": "plain", "primitives": []}],
    "skins": [{"joints": [3], "extensions": {"VENDOR_thing": {}}, "extras": null}],
    "animations": [{"name": "wag", "channels": [
        {"sampler": 0, "target": {"node": 0, "path": "weights"}}], "samplers": [{}]}],
    "materials": [{"name": "painted", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0,
        "extensions": {"KHR_texture_transform": {"offset": [0.5, 0.25]}}}}}],
    "textures": [{"source": 0, "sampler": 0}],
    "samplers": [{"magFilter": 9729, "extensions": {"VENDOR_thing": {"y": 1e-7}}}],
    "images": [{"uri": "pi%78el.png", "name": "pixel"}],
    "extensions": {"VENDOR_thing": {"accessor": 0, "deep": {"empty": {}, "none": null}}},
    "extras": {"note": "kept", "float": 0.10000000149011612, "large": 9007199254740993}
  })");
  Json primitives = MakePrimitives(&buffer);
  primitives[0]["material"] = 0;
  primitives[0]["attributes"]["TEXCOORD_0"] =
      buffer.AddFloats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 2, false);
  primitives[1]["extras"] = {{"second", true}};
  root["meshes"][0]["primitives"] = primitives;
  root["meshes"][1]["primitives"].push_back(
      {{"attributes", {{"POSITION", primitives[1]["attributes"]["POSITION"]}}}});
  Json& sampler = root["animations"][0]["samplers"][0];
  sampler["input"] = buffer.AddFloats({0, 1}, "SCALAR", 1, true, 0);
  sampler["output"] = buffer.AddFloats({0, 0, 1, 0.5f}, "SCALAR", 1, false, 0);
  root["accessors"] = buffer.accessors;
  root["accessors"][0]["extras"] = {{"mine", nullptr}};
  root["bufferViews"] = buffer.views;
  root["bufferViews"][0]["name"] = "first";
  root["buffers"] = {
      {{"uri", "data%20of%20it.bin"}, {"byteLength", buffer.bytes.size()}, {"name", "everything"}}};
  WriteAll(folder / "data of it.bin", buffer.bytes.data(), buffer.bytes.size());
  WriteAll(folder / "pixel.png", kPng, sizeof(kPng));
  const std::string text = root.dump(1);
  WriteAll(folder / "source.gltf", text.data(), text.size());
  return folder / "source.gltf";
}

std::filesystem::path WritePlainSource(const std::filesystem::path& folder) {
  BufferBuilder buffer;
  const Json primitives = MakePrimitives(&buffer);
  Json root = {{"asset", {{"version", "2.0"}}},
               {"scene", 0},
               {"scenes", Json::array({{{"nodes", Json::array({0})}}})},
               {"nodes", Json::array({{{"name", "sheet"}, {"mesh", 0}}})},
               {"meshes", Json::array({{{"primitives", primitives}}})},
               {"accessors", buffer.accessors},
               {"bufferViews", buffer.views},
               {"buffers", Json::array({{{"byteLength", buffer.bytes.size()}}})}};
  const auto bytes = bake::AssembleGlb(root.dump(), buffer.bytes);
  WriteAll(folder / "plain.glb", bytes->data(), bytes->size());
  return folder / "plain.glb";
}

bake::BakedCharacter MakeSyntheticBake(const bake::RawCharacter& raw,
                                       const SyntheticOptions& options) {
  std::mt19937 random(options.seed);
  bake::BakedCharacter baked;
  SkinMesh& mesh = baked.mesh;
  RigTables& tables = baked.tables;
  Weld(raw, &mesh);
  mesh.num_handles = options.num_handles;
  mesh.num_shapes = static_cast<int32_t>(raw.shapes.size());
  tables.num_groups = options.num_groups;
  tables.num_modes = 7;
  tables.num_single_modes = 4;
  tables.residual_rank = options.residual_rank;
  tables.has_rotations = options.rotations;
  tables.space.origin = {0.3f, -0.7f, 1.0f / 7};
  tables.space.scale = 1.7f;
  tables.shape_names.assign(raw.shape_names.begin(), raw.shape_names.end());
  FillHandles(raw, options.num_handles, mesh, &tables);
  VisitRigTables(tables,
                 [&random](const char*, Vector<float>& table, const Vector<int64_t>& shape) {
                   int64_t count = 1;
                   for (const int64_t size : shape)
                     count *= size;
                   table = RandomNumbers(count, &random);
                 });
  for (float& length : tables.handle_reach)
    length = std::abs(length);
  const auto num_handles = static_cast<size_t>(options.num_handles);
  mesh.weights = RandomNumbers(int64_t{mesh.num_solve_vertices} * options.num_handles, &random);
  for (size_t v = 0; v < mesh.num_solve_vertices; ++v) {
    float* row = mesh.weights.data() + v * num_handles;
    float sum = 0;
    for (size_t h = 0; h < num_handles; ++h)
      sum += row[h] += 0.75f;
    for (size_t h = 0; h < num_handles; ++h)
      row[h] /= sum;
  }
  FillShapes(raw, tables.space, &mesh);
  mesh.triangles = raw.triangles;
  mesh.primitives = raw.primitives;
  mesh.rest_normals = raw.normals;
  mesh.rest_tangents = raw.tangents;
  mesh.texcoords = raw.texcoords;
  mesh.source_vertex = raw.source_vertex;
  mesh.num_source_vertices = raw.num_source_vertices;
  CompleteRestFrames(tables.space.basis, &mesh);
  return baked;
}

Vector<uint8_t> ReadBytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

nlohmann::ordered_json ReadGltfJson(const std::filesystem::path& path) {
  const Vector<uint8_t> bytes = ReadBytes(path);
  if (!IsGlb(bytes)) return Json::parse(bytes);
  const auto chunks = SplitGlb(bytes);
  return Json::parse(chunks->json);
}

}  // namespace limber::test
