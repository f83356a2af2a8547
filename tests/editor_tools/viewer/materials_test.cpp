#include "viewer/materials.h"

#include "core/vector.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

namespace limber::viewer {
namespace {

class MaterialsTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::string& content) {
    std::filesystem::path path = folder_.path() / name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }

  std::string Png() {
    Image image;
    image.width = image.height = 2;
    image.rgba.assign(16, 200);
    EXPECT_TRUE(WritePng(folder_.path() / "texture.png", image).ok());
    std::ifstream file(folder_.path() / "texture.png", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  static std::string Glb(std::string json, std::string binary) {
    while (json.size() % 4 != 0)
      json += ' ';
    while (binary.size() % 4 != 0)
      binary += '\0';
    const auto word = [](uint32_t value) {
      std::string bytes(4, '\0');
      std::memcpy(bytes.data(), &value, 4);
      return bytes;
    };
    const auto json_size = static_cast<uint32_t>(json.size());
    const auto binary_size = static_cast<uint32_t>(binary.size());
    return "glTF" + word(2) + word(28 + json_size + binary_size) + word(json_size) + "JSON" + json +
           word(binary_size) + std::string("BIN\0", 4) + binary;
  }

  test::TemporaryFolder folder_;
};

constexpr char kTextured[] = R"("textures":[{"source":0,"sampler":0}],
  "samplers":[{"wrapS":33071,"magFilter":9728}],
  "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.75],
    "baseColorTexture":{"index":0},"roughnessFactor":0.3,"metallicFactor":0},
    "alphaMode":"MASK","alphaCutoff":0.25,"doubleSided":true,
    "extensions":{"KHR_materials_unlit":{}}}])";

// A glTF's JSON with these members, among them the images, and one material that uses the first.
std::string Textured(const std::string& members) {
  return "{" + members + "," + kTextured + "}";
}

void ExpectTextured(const Result<MaterialSet>& set) {
  ASSERT_TRUE(set.ok()) << set.status().message();
  ASSERT_EQ(set->materials.size(), 1u);
  const Material& material = set->materials[0];
  EXPECT_EQ(material.base_color, (std::array<float, 4>{0.5f, 0.25f, 1, 0.75f}));
  EXPECT_EQ(material.base_color_texture.image, 0);
  EXPECT_FALSE(material.base_color_texture.repeat_u);
  EXPECT_TRUE(material.base_color_texture.repeat_v);
  EXPECT_TRUE(material.base_color_texture.nearest);
  EXPECT_EQ(material.alpha_mode, AlphaMode::kMask);
  EXPECT_FLOAT_EQ(material.alpha_cutoff, 0.25f);
  EXPECT_FLOAT_EQ(material.roughness, 0.3f);
  EXPECT_TRUE(material.double_sided);
  EXPECT_TRUE(material.unlit);
  ASSERT_EQ(set->images.size(), 1u);
  EXPECT_EQ(set->images[0].rgba, Vector<uint8_t>(16, 200));
  EXPECT_TRUE(set->warnings.empty());
}

TEST_F(MaterialsTest, BinaryChunk_IsRead) {
  const std::string png = Png();
  const std::string json = Textured(
      R"("buffers":[{"byteLength":)" + std::to_string(png.size() + 8) +
      R"(}],"bufferViews":[{"buffer":0,"byteOffset":8,"byteLength":)" + std::to_string(png.size()) +
      R"(}],"images":[{"bufferView":0,"mimeType":"image/png"}])");
  ExpectTextured(ReadMaterials(Write("a.glb", Glb(json, std::string(8, 'x') + png))));
}

TEST_F(MaterialsTest, FileBesideTheGltf_IsRead) {
  const std::string png = Png();
  Write("my image.png", png);
  const std::string json = Textured(R"("images":[{"uri":"my%20image.png"}])");
  ExpectTextured(ReadMaterials(Write("a.gltf", json)));
}

TEST_F(MaterialsTest, BrokenImages_LeaveAWarningAndNoTexture) {
  const char* images[] = {R"({"uri":"../secret.png"})",
                          R"({"uri":"/etc/passwd"})",
                          R"({"uri":"http://example.org/a.png"})",
                          R"({"uri":"missing.png"})",
                          R"({"uri":"data:image/png;base64,AAAA"})",
                          R"({"uri":"data:image/png,raw"})",
                          R"({"bufferView":0})",
                          R"({"bufferView":-1})",
                          R"({"bufferView":1e300})",
                          R"({})",
                          R"(null)",
                          R"({"uri":7})"};
  for (const char* image : images) {
    const std::string json = Textured(R"("images":[)" + std::string(image) + "]");
    const Result<MaterialSet> set = ReadMaterials(Write("a.gltf", json));
    ASSERT_TRUE(set.ok()) << image;
    EXPECT_EQ(set->materials.at(0).base_color_texture.image, -1) << image;
    EXPECT_EQ(set->warnings.size(), 1u) << image;
  }
}

TEST_F(MaterialsTest, BufferViewsOutOfRange_AreNotFollowed) {
  const char* views[] = {
      R"({"buffer":0,"byteOffset":0,"byteLength":9007199254740992})",
      R"({"buffer":0,"byteOffset":9223372036854775807,"byteLength":9223372036854775807})",
      R"({"buffer":0,"byteOffset":-4,"byteLength":4})",
      R"({"buffer":5,"byteLength":4})",
      R"({"buffer":0})",
      "7"};
  for (const char* view : views) {
    const std::string json = Textured(R"("buffers":[{"byteLength":8}],"bufferViews":[)" +
                                      std::string(view) + R"(],"images":[{"bufferView":0}])");
    const Result<MaterialSet> set = ReadMaterials(Write("a.glb", Glb(json, "12345678")));
    ASSERT_TRUE(set.ok()) << view;
    EXPECT_EQ(set->warnings.size(), 1u) << view;
  }
}

TEST_F(MaterialsTest, ValuesOfTheWrongKind_CountAsAbsent) {
  const Result<MaterialSet> set = ReadMaterials(Write("a.gltf", R"({"materials":[7,null,
    {"pbrMetallicRoughness":{"baseColorFactor":[1,"x",null,1e40],"roughnessFactor":-3},
     "alphaMode":4,"doubleSided":"yes"}]})"));
  ASSERT_TRUE(set.ok());
  ASSERT_EQ(set->materials.size(), 3u);
  EXPECT_EQ(set->materials[2].base_color, (std::array<float, 4>{1, 1, 1, 1}));
  EXPECT_FLOAT_EQ(set->materials[2].roughness, 1);
  EXPECT_FALSE(set->materials[2].double_sided);
}

TEST_F(MaterialsTest, WhatIsNoGltf_IsAnError) {
  EXPECT_EQ(ReadMaterials(folder_.path() / "none.glb").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(ReadMaterials(Write("a.gltf", "{\"a\":")).status().code(), StatusCode::kMalformed);
  EXPECT_EQ(ReadMaterials(Write("b.gltf", "")).status().code(), StatusCode::kMalformed);
  EXPECT_EQ(ReadMaterials(Write("c.gltf", std::string(100000, '['))).status().code(),
            StatusCode::kMalformed);
  std::string cut = Glb("{}", "");
  cut[12] = 100;
  EXPECT_EQ(ReadMaterials(Write("d.glb", cut)).status().code(), StatusCode::kMalformed);
}

}  // namespace
}  // namespace limber::viewer
