#include "runtime/load/small_gltf.h"

#include "core/vector.h"
#include "load/uri.h"

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

void Append(uint32_t number, Vector<uint8_t>* bytes) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes->push_back(static_cast<uint8_t>(number >> shift));
  }
}

}  // namespace

SmallGltf::SmallGltf() {
  json = Json::parse(R"({
    "asset": {"version": "2.0"},
    "nodes": [{"mesh": 0, "name": "thing"}],
    "meshes": [{"name": "m", "primitives": [{"attributes": {"POSITION": 0}, "indices": 2,
      "targets": [{"POSITION": 1}]}]}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
      {"bufferView": 2, "componentType": 5121, "count": 3, "type": "SCALAR"}],
    "bufferViews": [], "buffers": [{}]})");
  AddView<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
  AddView<float>({0, 0, 1, 0, 0, 1, 0, 0, 2});
  AddView<uint8_t>({0, 1, 2});
}

size_t SmallGltf::AddBytes(const void* data, size_t size, size_t stride) {
  bin.resize((bin.size() + 3) / 4 * 4);
  Json view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", size}};
  if (stride > 0) view["byteStride"] = stride;
  const auto* bytes = static_cast<const uint8_t*>(data);
  bin.insert(bin.end(), bytes, bytes + size);
  json["bufferViews"].push_back(view);
  json["buffers"][0]["byteLength"] = bin.size();
  return json["bufferViews"].size() - 1;
}

size_t SmallGltf::AddAccessor(const Json& accessor) {
  json["accessors"].push_back(accessor);
  return json["accessors"].size() - 1;
}

std::string SmallGltf::Text() const {
  Json whole = json;
  if (whole.contains("buffers") && whole["buffers"].is_array() && !whole["buffers"].empty() &&
      whole["buffers"][0].is_object() && !whole["buffers"][0].contains("uri")) {
    whole["buffers"][0]["uri"] = "data:application/octet-stream;base64," + EncodeBase64(bin);
  }
  return whole.dump();
}

Vector<uint8_t> SmallGltf::Glb() const {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  Vector<uint8_t> padded = bin, bytes;
  padded.resize((bin.size() + 3) / 4 * 4);
  for (const size_t number : {size_t{0x46546C67}, size_t{2}, 28 + text.size() + padded.size(),
                              text.size(), size_t{0x4E4F534A}}) {
    Append(static_cast<uint32_t>(number), &bytes);
  }
  bytes.insert(bytes.end(), text.begin(), text.end());
  Append(static_cast<uint32_t>(padded.size()), &bytes);
  Append(0x004E4942, &bytes);
  bytes.insert(bytes.end(), padded.begin(), padded.end());
  return bytes;
}

Result<GltfFile> ParseText(const std::string& text) {
  return GltfFile::Parse({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "test.gltf");
}

Result<GltfFile> SmallGltf::Parse() const {
  return ParseText(Text());
}

}  // namespace limber::test
