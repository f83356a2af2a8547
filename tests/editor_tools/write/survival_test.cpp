// Whatever else a source file holds is in the baked file, unchanged.
#include "bake/write_baked.h"
#include "editor_tools/write/synthetic_bake.h"
#include "import/import_gltf.h"
#include "load/gltf_mesh.h"
#include "load/rig_loader.h"
#include "rig/rig_fields.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Files {
  TemporaryFolder folder;
  fs::path source, out;
};

void Bake(Files* files, const char* output) {
  files->source = WriteRichSource(files->folder.path());
  files->out = files->folder.path() / output;
  const auto raw = bake::ImportGltf(files->source);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  const Status status =
      bake::WriteBaked(files->source, *raw, MakeSyntheticBake(*raw, {}), files->out);
  ASSERT_TRUE(status.ok()) << status.message();
}

// Takes out what the bake may add, so that the rest can be compared.
void StripBake(const Json& source, Json* baked) {
  (*baked)["extensions"].erase(kRigExtensionName);
  Json& used = (*baked)["extensionsUsed"];
  ASSERT_EQ(used.back(), kRigExtensionName);
  used.erase(used.size() - 1);
  for (Json& primitive : (*baked)["meshes"][0]["primitives"]) {
    primitive["attributes"].erase(kWeldAttribute);
    primitive["attributes"].erase(kGroupAttribute);
    primitive["attributes"].erase("_LIMBER_WEIGHTS_0");
    primitive["attributes"].erase("_LIMBER_WEIGHTS_1");
  }
  (*baked)["nodes"][0]["extensions"].erase(kRigExtensionName);
  (*baked)["nodes"][0].erase("children");
  for (const char* section : {"nodes", "accessors", "bufferViews"}) {
    Json& items = (*baked)[section];
    while (items.size() > source[section].size())
      items.erase(items.size() - 1);
  }
  // The buffer and the image now lie inside the file.
  Json& buffer = (*baked)["buffers"][0];
  buffer["byteLength"] = source["buffers"][0]["byteLength"];
  Json& image = (*baked)["images"][0];
  EXPECT_EQ(image["mimeType"], "image/png");
  image.erase("bufferView");
  image.erase("mimeType");
}

class Survival : public testing::TestWithParam<const char*> {};

TEST_P(Survival, RestOfTheJson_IsEqual) {
  Files files;
  Bake(&files, GetParam());
  Json source = ReadGltfJson(files.source), baked = ReadGltfJson(files.out);
  StripBake(source, &baked);
  baked["buffers"][0].erase("uri");
  source["buffers"][0].erase("uri");
  source["images"][0].erase("uri");
  // Unordered comparison: members may move, none may go, come or change.
  const nlohmann::json expected = nlohmann::json::parse(source.dump());
  const nlohmann::json found = nlohmann::json::parse(baked.dump());
  EXPECT_EQ(nlohmann::json::diff(expected, found), nlohmann::json::array());
}

INSTANTIATE_TEST_SUITE_P(Formats, Survival, testing::Values("out.glb", "out.gltf"),
                         [](const auto& test) { return std::string(test.param).substr(4); });

TEST(Survival, Data_IsEqualByteForByte) {
  Files files;
  Bake(&files, "out.glb");
  const auto source = GltfFile::Open(files.source), baked = GltfFile::Open(files.out);
  ASSERT_TRUE(source.ok() && baked.ok());
  const size_t num_views = source->json()["bufferViews"].size();
  ASSERT_GT(num_views, 5u);
  for (size_t view = 0; view < num_views; ++view) {
    const auto a = source->BufferViewBytes(static_cast<int64_t>(view));
    const auto b = baked->BufferViewBytes(static_cast<int64_t>(view));
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << "bufferView " << view;
  }
  const auto image = source->ImageBytes(0), baked_image = baked->ImageBytes(0);
  ASSERT_TRUE(image.ok() && baked_image.ok());
  EXPECT_EQ(*image, *baked_image);
}

TEST(Survival, BakedFileAlone_NeedsNothingBesideIt) {
  Files files;
  Bake(&files, "out.glb");
  fs::remove(files.folder.path() / "data of it.bin");
  fs::remove(files.folder.path() / "pixel.png");
  fs::remove(files.source);
  EXPECT_TRUE(LoadRig(files.out).ok());
  const auto file = GltfFile::Open(files.out);
  ASSERT_TRUE(file.ok());
  EXPECT_TRUE(file->ImageBytes(0).ok());
}

TEST(Survival, ExtensionStripped_IsTheSameMesh) {
  Files files;
  Bake(&files, "out.gltf");
  Json json = ReadGltfJson(files.out);
  json["extensions"].erase(kRigExtensionName);
  json["nodes"][0]["extensions"].erase(kRigExtensionName);
  const std::string text = json.dump();
  const auto stripped =
      GltfFile::Parse({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "stripped");
  const auto source = GltfFile::Open(files.source);
  ASSERT_TRUE(stripped.ok() && source.ok());
  const auto mesh = ReadMorphMesh(*stripped, 0), original = ReadMorphMesh(*source, 0);
  ASSERT_TRUE(mesh.ok() && original.ok());
  EXPECT_EQ(HashMesh(*mesh), HashMesh(*original));
  EXPECT_EQ(mesh->normals, original->normals);
  EXPECT_EQ(mesh->target_names, original->target_names);
}

TEST(Survival, MissingTexture_IsNamedAndNothingIsWritten) {
  const TemporaryFolder folder;
  const fs::path source = WriteRichSource(folder.path());
  const auto raw = bake::ImportGltf(source);
  ASSERT_TRUE(raw.ok());
  fs::remove(folder.path() / "pixel.png");
  const fs::path out = folder.path() / "out.glb";
  const Status before = bake::CheckBeforeBake(source, *raw, 2, out);
  const Status status = bake::WriteBaked(source, *raw, MakeSyntheticBake(*raw, {}), out);
  EXPECT_EQ(before.code(), StatusCode::kNotFound);
  EXPECT_EQ(before.message(), status.message());
  EXPECT_NE(status.message().find("pixel.png"), std::string::npos) << status.message();
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace limber::test
