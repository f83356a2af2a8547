// One mesh out of primitives of every kind.
#include "core/vector.h"
#include "load/gltf_mesh.h"
#include "runtime/load/small_gltf.h"

#include <gtest/gtest.h>

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

Result<GltfMorphMesh> Read(const SmallGltf& gltf) {
  const auto file = gltf.Parse();
  if (!file.ok()) return file.status();
  return ReadMorphMesh(*file, 0);
}

TEST(MorphMesh, Triangle_HasItsShapes) {
  const auto mesh = Read(SmallGltf());
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_EQ(mesh->num_vertices(), 3u);
  EXPECT_EQ(mesh->triangles, (Vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(mesh->positions[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(mesh->targets[0][2], (Vec3{0, 0, 2}));
  EXPECT_EQ(mesh->target_names, (Vector<std::string>{"target_0"}));
}

TEST(MorphMesh, StripAndFan_BecomeTriangles) {
  SmallGltf gltf;
  const size_t view = gltf.AddView<uint8_t>({0, 1, 2, 2, 0, 1});
  const size_t indices = gltf.AddAccessor(
      {{"bufferView", view}, {"componentType", 5121}, {"count", 6}, {"type", "SCALAR"}});
  Json& primitive = gltf.json["meshes"][0]["primitives"][0];
  primitive["indices"] = indices;
  primitive["mode"] = 5;
  auto mesh = Read(gltf);
  ASSERT_TRUE(mesh.ok());
  // (0 1 2), then two that repeat a corner are dropped, then (2 0 1), turned as its place asks.
  EXPECT_EQ(mesh->triangles, (Vector<uint32_t>{0, 1, 2, 2, 1, 0}));
  primitive["mode"] = 6;
  mesh = Read(gltf);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh->triangles, (Vector<uint32_t>{0, 1, 2}));
}

TEST(MorphMesh, PrimitiveWithoutTargets_StaysAtRest) {
  SmallGltf gltf;
  Json second = gltf.json["meshes"][0]["primitives"][0];
  second.erase("targets");
  second.erase("indices");
  gltf.json["meshes"][0]["primitives"].push_back(second);
  const auto mesh = Read(gltf);
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  ASSERT_EQ(mesh->num_vertices(), 6u);
  EXPECT_EQ(mesh->targets[0][2], (Vec3{0, 0, 2}));
  EXPECT_EQ(mesh->targets[0][5], Vec3());
  EXPECT_EQ(mesh->triangles, (Vector<uint32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(mesh->primitives[1].first_vertex, 3u);
}

TEST(MorphMesh, UnequalTargetCounts_AreNamed) {
  SmallGltf gltf;
  Json second = gltf.json["meshes"][0]["primitives"][0];
  second["targets"].push_back({{"POSITION", 1}});
  gltf.json["meshes"][0]["primitives"].push_back(second);
  const auto mesh = Read(gltf);
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.status().code(), StatusCode::kMalformed);
  EXPECT_NE(mesh.status().message().find("primitives[1]: 2 morph targets"), std::string::npos)
      << mesh.status().message();
}

TEST(MorphMesh, NoTarget_NamesBlendersUsualCause) {
  SmallGltf gltf;
  gltf.json["meshes"][0]["primitives"][0].erase("targets");
  const auto mesh = Read(gltf);
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.status().code(), StatusCode::kNoExamples);
  EXPECT_NE(mesh.status().message().find("Apply Modifiers"), std::string::npos);
}

TEST(MorphMesh, PointsAndLines_AreLeftOutWithAWarning) {
  SmallGltf gltf;
  Json points = gltf.json["meshes"][0]["primitives"][0];
  points["mode"] = 0;
  gltf.json["meshes"][0]["primitives"].push_back(points);
  const auto mesh = Read(gltf);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh->primitives.size(), 1u);
  EXPECT_EQ(mesh->warnings.size(), 1u);
}

TEST(MorphMesh, Hash_SeesWhatABakeDependsOn) {
  const SmallGltf gltf;
  const std::string hash = HashMesh(*Read(gltf));
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash, HashMesh(*Read(gltf)));
  for (size_t byte = 3; byte < gltf.bin.size() - 4; byte += 4) {
    SmallGltf changed = gltf;
    changed.bin[byte] = static_cast<uint8_t>(changed.bin[byte] ^ 0x3E);
    EXPECT_NE(HashMesh(*Read(changed)), hash) << byte;
  }
  SmallGltf turned = gltf;
  std::swap(turned.bin[72], turned.bin[73]);
  EXPECT_NE(HashMesh(*Read(turned)), hash) << "indices";
  SmallGltf renamed = gltf;
  renamed.json["meshes"][0]["name"] = "other";
  EXPECT_EQ(HashMesh(*Read(renamed)), hash);
}

}  // namespace
}  // namespace limber::test
