#include "generate/write_glb.h"

#include "generate/canvas.h"

#include <nlohmann/json.hpp>

#include <cstring>
#include <limits>
#include <string>

namespace limber::content {
namespace {

// Ordered, so that a reader of the file finds the keys in the order they were written.
using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963;

class GlbWriter {
 public:
  explicit GlbWriter(const Character& character) : character_(character) {
    json_["asset"] = {{"version", "2.0"},
                      {"generator", "limber_make_content"},
                      {"copyright", "Dedicated to the public domain (CC0 1.0)"}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"nodes", {0}}}});
  }

  std::vector<uint8_t> Write() {
    AddNodes();
    AddMaterials();
    AddMesh();
    AddPicture();
    json_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
    return Container();
  }

 private:
  template <class T>
  void Append(T value) {
    const size_t at = binary_.size();
    binary_.resize(at + sizeof(T));
    std::memcpy(&binary_[at], &value, sizeof(T));
  }

  // A view of everything since `start`, padded to 4 bytes; its number.
  size_t AddView(size_t start, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", start}, {"byteLength", binary_.size() - start}};
    if (target != 0) view["target"] = target;
    while (binary_.size() % 4 != 0)
      binary_.push_back(0);
    json_["bufferViews"].push_back(std::move(view));
    return json_["bufferViews"].size() - 1;
  }

  size_t AddAccessor(Json accessor) {
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }

  // `value(v)` for the vertices of one primitive, as floats; with bounds where asked.
  template <class Value>
  size_t AddVectors(const Primitive& primitive, bool bounds, const Value& value) {
    using Vector = decltype(value(0u));
    const size_t start = binary_.size();
    Vector low = Vector::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (uint32_t v = 0; v < primitive.num_vertices; ++v) {
      const Vector x = value(primitive.first_vertex + v);
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
      for (int c = 0; c < Vector::RowsAtCompileTime; ++c)
        Append(static_cast<float>(x[c]));
    }
    Json accessor = {{"bufferView", AddView(start, kVertexBuffer)},
                     {"componentType", kFloat},
                     {"count", primitive.num_vertices},
                     {"type", Vector::RowsAtCompileTime == 2 ? "VEC2" : "VEC3"}};
    for (int c = 0; bounds && c < Vector::RowsAtCompileTime; ++c) {
      accessor["min"].push_back(static_cast<float>(low[c]));
      accessor["max"].push_back(static_cast<float>(high[c]));
    }
    return AddAccessor(std::move(accessor));
  }

  size_t AddIndices(const Primitive& primitive) {
    const size_t start = binary_.size();
    const bool narrow = primitive.num_vertices < 65535;
    for (uint32_t v : primitive.triangles) {
      if (narrow) {
        Append(static_cast<uint16_t>(v));
      } else {
        Append(v);
      }
    }
    return AddAccessor({{"bufferView", AddView(start, kIndexBuffer)},
                        {"componentType", narrow ? kUnsignedShort : kUnsignedInt},
                        {"count", primitive.triangles.size()},
                        {"type", "SCALAR"}});
  }

  Json MakePrimitive(const Primitive& primitive) {
    const std::vector<Vector3d>& rest = character_.shapes[0].positions;
    Json json;
    json["attributes"] = {
        {"POSITION", AddVectors(primitive, true, [&](uint32_t v) { return rest[v]; })},
        {"NORMAL", AddVectors(primitive, false, [&](uint32_t v) { return character_.normals[v]; })},
        {"TEXCOORD_0",
         AddVectors(primitive, false, [&](uint32_t v) { return character_.texcoords[v]; })}};
    json["indices"] = AddIndices(primitive);
    json["material"] = primitive.material;
    json["targets"] = Json::array();
    for (size_t s = 1; s < character_.shapes.size(); ++s) {
      const std::vector<Vector3d>& shape = character_.shapes[s].positions;
      const auto offset = [&](uint32_t v) { return Vector3d(shape[v] - rest[v]); };
      json["targets"].push_back({{"POSITION", AddVectors(primitive, true, offset)}});
    }
    return json;
  }

  void AddMesh() {
    Json mesh = {{"name", character_.name}, {"primitives", Json::array()}};
    for (const Primitive& primitive : character_.primitives) {
      mesh["primitives"].push_back(MakePrimitive(primitive));
    }
    for (size_t s = 1; s < character_.shapes.size(); ++s) {
      mesh["weights"].push_back(0);
      mesh["extras"]["targetNames"].push_back(character_.shapes[s].name);
    }
    json_["meshes"] = Json::array({std::move(mesh)});
  }

  void AddNodes() {
    Json root = {{"name", character_.name}, {"mesh", 0}, {"children", Json::array()}};
    json_["nodes"] = Json::array({nullptr});
    for (const Handle& handle : character_.handles) {
      const Vector3d& p = character_.shapes[0].positions[handle.vertex];
      Json node = {{"name", handle.name}, {"translation", {p.x(), p.y(), p.z()}}};
      if (handle.pinned) {
        node["extras"]["limber_handle"] = true;
      } else {
        node["extras"]["limber_handle"]["pinned"] = false;
      }
      root["children"].push_back(json_["nodes"].size());
      json_["nodes"].push_back(std::move(node));
    }
    json_["nodes"][0] = std::move(root);
  }

  void AddMaterials() {
    for (const Material& material : character_.materials) {
      Json json = {{"name", material.name},
                   {"pbrMetallicRoughness",
                    {{"baseColorTexture", {{"index", 0}}},
                     {"metallicFactor", 0},
                     {"roughnessFactor", material.roughness}}}};
      if (material.alpha_cut) {
        json["alphaMode"] = "MASK";
        json["alphaCutoff"] = 0.5;
      }
      if (material.double_sided) json["doubleSided"] = true;
      json_["materials"].push_back(std::move(json));
    }
  }

  void AddPicture() {
    const size_t start = binary_.size();
    const std::vector<uint8_t> png = EncodePng(character_.picture);
    binary_.insert(binary_.end(), png.begin(), png.end());
    json_["textures"] = Json::array({{{"sampler", 0}, {"source", 0}}});
    json_["samplers"] = Json::array(
        {{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33071}}});
    json_["images"] = Json::array({{{"name", character_.name},
                                    {"mimeType", "image/png"},
                                    {"bufferView", AddView(start, 0)}}});
  }

  std::vector<uint8_t> Container() {
    std::string text = json_.dump();
    while (text.size() % 4 != 0)
      text.push_back(' ');
    const std::vector<uint8_t> body = std::move(binary_);
    binary_.clear();
    const auto word = [this](size_t value) { Append(static_cast<uint32_t>(value)); };
    word(0x46546C67);  // "glTF"
    word(2);
    word(12 + 8 + text.size() + 8 + body.size());
    word(text.size());
    word(0x4E4F534A);  // "JSON"
    binary_.insert(binary_.end(), text.begin(), text.end());
    word(body.size());
    word(0x004E4942);  // "BIN"
    binary_.insert(binary_.end(), body.begin(), body.end());
    return std::move(binary_);
  }

  const Character& character_;
  Json json_;
  std::vector<uint8_t> binary_;
};

}  // namespace

std::vector<uint8_t> WriteGlb(const Character& character) {
  return GlbWriter(character).Write();
}

}  // namespace limber::content
