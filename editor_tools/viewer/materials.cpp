#include "viewer/materials.h"

#include "core/vector.h"
#include "viewer/gltf_bytes.h"
#include "viewer/texture.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <map>

namespace limber::viewer {
namespace {

using Json = nlohmann::json;

// Reading JSON that may hold anything: a value of the wrong kind counts as absent.
const Json& Member(const Json& object, const char* key) {
  static const Json absent;
  if (!object.is_object()) return absent;
  const auto found = object.find(key);
  return found == object.end() ? absent : *found;
}

const Json& Element(const Json& object, const char* key, int index) {
  static const Json absent;
  const Json& array = Member(object, key);
  if (!array.is_array() || index < 0 || static_cast<size_t>(index) >= array.size()) return absent;
  return array[static_cast<size_t>(index)];
}

int Index(const Json& value) {
  if (!value.is_number_integer()) return -1;
  const auto index = value.get<int64_t>();
  return index >= 0 && index < (1 << 30) ? static_cast<int>(index) : -1;
}

float Number(const Json& value, float otherwise, float low, float high) {
  if (!value.is_number()) return otherwise;
  const double number = value.get<double>();
  return number >= low && number <= high ? static_cast<float>(number) : otherwise;
}

// Decodes each image once, when the first texture asks for it.
class ImageReader {
 public:
  ImageReader(const GltfBytes& file, MaterialSet* set) : file_(file), set_(set) {}

  MaterialTexture Texture(const Json& info) {
    MaterialTexture texture;
    if (!info.is_object()) return texture;
    const Json& coordinates = Member(info, "texCoord");
    if (coordinates.is_number_integer() && coordinates.get<int64_t>() != 0) {
      set_->warnings.emplace_back("a texture uses a second set of coordinates; left out");
      return texture;
    }
    const Json& entry = Element(file_.json(), "textures", Index(Member(info, "index")));
    texture.image = Read(Index(Member(entry, "source")));
    const Json& sampler = Element(file_.json(), "samplers", Index(Member(entry, "sampler")));
    constexpr int kClampToEdge = 33071, kNearest = 9728;
    texture.repeat_u = Index(Member(sampler, "wrapS")) != kClampToEdge;
    texture.repeat_v = Index(Member(sampler, "wrapT")) != kClampToEdge;
    texture.nearest = Index(Member(sampler, "magFilter")) == kNearest;
    return texture;
  }

 private:
  int Read(int index) {
    if (index < 0) return -1;
    const auto known = decoded_.find(index);
    if (known != decoded_.end()) return known->second;
    int& slot = decoded_[index] = -1;
    Result<Vector<uint8_t>> bytes = file_.ReadImageBytes(Element(file_.json(), "images", index));
    Result<Image> image = bytes.ok() ? DecodeImage(*bytes) : Result<Image>(bytes.status());
    if (!image.ok()) {
      set_->warnings.push_back("image " + std::to_string(index) + ": " + image.status().message() +
                               "; drawn without it");
      return -1;
    }
    slot = static_cast<int>(set_->images.size());
    set_->images.push_back(std::move(*image));
    return slot;
  }

  const GltfBytes& file_;
  MaterialSet* set_;
  std::map<int, int> decoded_;
};

Material ReadMaterial(const Json& json, ImageReader* images) {
  Material material;
  const Json& surface = Member(json, "pbrMetallicRoughness");
  const Json& color = Member(surface, "baseColorFactor");
  if (color.is_array() && color.size() == 4) {
    for (size_t i = 0; i < 4; ++i)
      material.base_color[i] = Number(color[i], 1, 0, 1);
  }
  material.base_color_texture = images->Texture(Member(surface, "baseColorTexture"));
  const Json& normal = Member(json, "normalTexture");
  material.normal_texture = images->Texture(normal);
  material.normal_scale = Number(Member(normal, "scale"), 1, -100, 100);
  material.roughness = Number(Member(surface, "roughnessFactor"), 1, 0, 1);
  material.metallic = Number(Member(surface, "metallicFactor"), 1, 0, 1);
  // Metal mirrors its surroundings, and this studio has none to show; keep some body colour.
  material.metallic = std::min(material.metallic, 0.6f);
  const Json& mode = Member(json, "alphaMode");
  if (mode == "MASK") material.alpha_mode = AlphaMode::kMask;
  if (mode == "BLEND") material.alpha_mode = AlphaMode::kBlend;
  material.alpha_cutoff = Number(Member(json, "alphaCutoff"), 0.5f, 0, 1);
  material.double_sided = Member(json, "doubleSided") == true;
  material.unlit = Member(Member(json, "extensions"), "KHR_materials_unlit").is_object();
  return material;
}

}  // namespace

Material DefaultMaterial() {
  Material material;
  material.base_color = {0.66f, 0.58f, 0.50f, 1};
  material.roughness = 0.62f;
  material.double_sided = true;
  return material;
}

Result<MaterialSet> ReadMaterials(const std::filesystem::path& path) {
  Result<GltfBytes> file = GltfBytes::Open(path);
  if (!file.ok()) return file.status();
  MaterialSet set;
  ImageReader images(*file, &set);
  const Json& materials = Member(file->json(), "materials");
  if (!materials.is_array()) return set;
  for (const Json& material : materials) {
    set.materials.push_back(ReadMaterial(material, &images));
  }
  return set;
}

}  // namespace limber::viewer
