// Clips on handle nodes against closed forms, in files whose nodes stand in all sorts of places.
#include "clips/handle_clips.h"

#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"
#include "load/glb_container.h"
#include "load/rig_loader.h"
#include "support/counting_allocator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

namespace limber::test {
namespace {

constexpr double kClose = 1e-6;

// The baked tube: the mesh is node 0, its handles nodes 1 to 4, all of them roots.
GltfParts BakedTube() {
  std::ifstream stream(std::string(LIMBER_SOURCE_DIR) + "/content/baked/v2/tube.glb",
                       std::ios::binary);
  const Vector<uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
  const Result<GlbChunks> chunks = SplitGlb(bytes);
  EXPECT_TRUE(chunks.ok());
  GltfParts parts;
  parts.json = nlohmann::ordered_json::parse(chunks->json);
  parts.bin.assign(chunks->bin.begin(), chunks->bin.end());
  return parts;
}

size_t AddAnimation(GltfParts* parts, const std::string& name) {
  parts->json["animations"].push_back({{"name", name},
                                       {"channels", nlohmann::ordered_json::array()},
                                       {"samplers", nlohmann::ordered_json::array()}});
  return parts->json["animations"].size() - 1;
}

Vector<float> AboutZ(double angle) {
  return {0, 0, static_cast<float>(std::sin(angle / 2)), static_cast<float>(std::cos(angle / 2))};
}

Vector<float> Joined(Vector<float> a, const Vector<float>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Loaded {
  std::shared_ptr<const Rig> rig;
  std::shared_ptr<const HandleClips> clips;
  Vector<std::string> warnings;
};

Loaded Load(const GltfParts& parts) {
  Loaded loaded;
  const Result<GltfFile> file = GltfFile::Parse(parts.Glb(), "tube");
  EXPECT_TRUE(file.ok()) << file.status().message();
  if (!file.ok()) return loaded;
  auto rig = LoadRig(*file);
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  if (!rig.ok()) return loaded;
  loaded.rig = *rig;
  auto clips = HandleClips::Read(*file, **rig, 0, &loaded.warnings);
  EXPECT_TRUE(clips.ok()) << clips.status().message();
  if (clips.ok()) loaded.clips = *clips;
  return loaded;
}

struct Sampled {
  HandlePlace place;
  bool is_turned;
};

Sampled PlaceIn(const Loaded& loaded, int clip, int handle, double time) {
  for (const ClipHandle& moved : loaded.clips->handles(clip)) {
    if (moved.handle == handle)
      return {loaded.clips->Sample(loaded.clips->MomentOf(clip, time), moved), moved.is_turned};
  }
  ADD_FAILURE() << "the clip does not move handle " << handle;
  return {};
}

Eigen::Vector3d At(const Vec3& v) {
  return {v.x, v.y, v.z};
}

TEST(HandleClips, TranslationOfAHandlesNode_MovesTheHandle) {
  GltfParts parts = BakedTube();
  AddChannel(&parts, AddAnimation(&parts, "Reach"), 3, "translation", {0, 2},
             {1.05f, 0, 0, 1.05f, 1, 0.5f});
  const Loaded loaded = Load(parts);
  ASSERT_EQ(loaded.clips->num_clips(), 1);
  EXPECT_EQ(loaded.clips->name(0), "Reach");
  EXPECT_EQ(loaded.clips->duration(0), 2);
  ASSERT_EQ(loaded.clips->handles(0).size(), 1u);
  const int right = loaded.rig->FindHandle("right");
  EXPECT_EQ(loaded.clips->handles(0)[0].handle, right);
  const auto [half, is_turned] = PlaceIn(loaded, 0, right, 1);
  EXPECT_LT((At(half.position) - Eigen::Vector3d(1.05, 0.5, 0.25)).norm(), kClose);
  EXPECT_FALSE(is_turned);
  const HandlePlace late = PlaceIn(loaded, 0, right, 99).place;
  EXPECT_LT((At(late.position) - Eigen::Vector3d(1.05, 1, 0.5)).norm(), kClose);
}

// A node that stands beside the handle's rest position takes it along as if it were fixed to it.
TEST(HandleClips, TurnOfANodeBesideTheHandle_SwingsTheHandleAroundIt) {
  GltfParts parts = BakedTube();
  parts.json["nodes"][3]["translation"] = {0.05, 0, 0};  // 1 beside the handle
  AddChannel(&parts, AddAnimation(&parts, "Swing"), 3, "rotation", {0, 1},
             Joined(AboutZ(0), AboutZ(M_PI / 2)));
  const Loaded loaded = Load(parts);
  const int right = loaded.rig->FindHandle("right");
  const double angle = 0.5 * M_PI / 2;
  const auto [place, is_turned] = PlaceIn(loaded, 0, right, 0.5);
  EXPECT_LT(
      (At(place.position) - Eigen::Vector3d(0.05 + std::cos(angle), std::sin(angle), 0)).norm(),
      kClose);
  ASSERT_TRUE(is_turned);
  EXPECT_NEAR(place.rotation.z, std::sin(angle / 2), kClose);
  EXPECT_NEAR(place.rotation.w, std::cos(angle / 2), kClose);
}

// What stands above both the mesh and the handle moves neither against the other; what stands above
// one of them does. Mesh space may be scaled and turned against the world.
TEST(HandleClips, NodesAbove_CountAgainstTheMesh) {
  GltfParts parts = BakedTube();
  auto& nodes = parts.json["nodes"];
  // 5 carries everything, 6 only the handle "left".
  nodes.push_back({{"name", "all"}, {"children", {0, 2, 3, 4, 6}}});
  nodes.push_back({{"name", "arm"}, {"children", {1}}, {"translation", {0, 0, 0}}});
  nodes[0]["rotation"] = AboutZ(0.7);
  nodes[0]["scale"] = {2, 2, 2};
  parts.json["scenes"][0]["nodes"] = {5};
  const size_t walk = AddAnimation(&parts, "Walk");
  AddChannel(&parts, walk, 5, "translation", {0, 1}, {0, 0, 0, 10, 3, -2});
  AddChannel(&parts, walk, 5, "rotation", {0, 1}, Joined(AboutZ(0), AboutZ(1)));
  const size_t wave = AddAnimation(&parts, "Wave");
  AddChannel(&parts, wave, 5, "translation", {0, 1}, {0, 0, 0, 10, 3, -2});
  AddChannel(&parts, wave, 6, "translation", {0, 1}, {0, 0, 0, 0, 2, 0});
  const size_t step = AddAnimation(&parts, "Step");
  AddChannel(&parts, step, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  const Loaded loaded = Load(parts);
  ASSERT_EQ(loaded.clips->num_clips(), 2) << "Walk moves no handle against the mesh";
  EXPECT_EQ(loaded.clips->Find("Walk"), -1);
  const int left = loaded.rig->FindHandle("left");
  const Eigen::Vector3d rest =
      At(loaded.rig->tables().handles[static_cast<size_t>(left)].rest_position);
  // Mesh space is the world turned back by 0.7 and halved.
  const auto to_mesh = [](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return 0.5 * (Eigen::AngleAxisd(-0.7, Eigen::Vector3d::UnitZ()) * v);
  };
  const int waving = loaded.clips->Find("Wave"), stepping = loaded.clips->Find("Step");
  ASSERT_EQ(loaded.clips->handles(waving).size(), 1u);
  const auto [waved, is_turned] = PlaceIn(loaded, waving, left, 0.5);
  EXPECT_LT((At(waved.position) - (rest + to_mesh({0, 1, 0}))).norm(), kClose);
  EXPECT_FALSE(is_turned);
  EXPECT_EQ(loaded.clips->handles(stepping).size(), 4u) << "they stay, and the mesh moves on";
  const HandlePlace stepped = PlaceIn(loaded, stepping, left, 1).place;
  EXPECT_LT((At(stepped.position) - (rest - to_mesh({1, 0, 0}))).norm(), kClose);
}

TEST(HandleClips, ClipThatCannotBeRead_IsLeftOutWithAWarning) {
  GltfParts parts = BakedTube();
  AddChannel(&parts, AddAnimation(&parts, "Good"), 3, "translation", {0, 2},
             {1.05f, 0, 0, 1.05f, 1, 0.5f});
  AddChannel(&parts, AddAnimation(&parts, "Bad"), 3, "translation", {2, 1},
             {1.05f, 0, 0, 1.05f, 1, 0.5f});
  const Loaded loaded = Load(parts);
  EXPECT_EQ(loaded.clips->num_clips(), 1);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_NE(loaded.warnings[0].find("animations[1]"), std::string::npos) << loaded.warnings[0];
}

// A file that would make work of clips times nodes: thousands of both, quickly done with.
TEST(HandleClips, DeepNodesAndManyClips_AreBounded) {
  GltfParts parts = BakedTube();
  auto& nodes = parts.json["nodes"];
  const size_t first = nodes.size();
  for (size_t i = 0; i < 3000; ++i)
    nodes.push_back({{"children", {i == 2999 ? size_t{3} : first + i + 1}}});
  parts.json["scenes"][0]["nodes"] = {0, 1, 2, 4, first};
  const size_t good = AddAnimation(&parts, "Good");
  AddChannel(&parts, good, 1, "translation", {0, 1}, {0, 0, 0, 0, 1, 0});
  const auto clip = parts.json["animations"][good];
  for (int i = 0; i < 2000; ++i)
    parts.json["animations"].push_back(clip);
  const Loaded loaded = Load(parts);
  EXPECT_EQ(loaded.clips->num_clips(), 1024);
  ASSERT_EQ(loaded.warnings.size(), 2u);
  EXPECT_NE(loaded.warnings[0].find("node 3: more than 256"), std::string::npos);
  EXPECT_NE(loaded.warnings[1].find("first 1024"), std::string::npos);
}

TEST(HandleClips, NodeOfAnotherName_IsAStranger) {
  GltfParts parts = BakedTube();
  parts.json["nodes"][3]["name"] = "lamp";
  AddChannel(&parts, AddAnimation(&parts, "Reach"), 3, "translation", {0, 2},
             {1.05f, 0, 0, 1.05f, 1, 0.5f});
  EXPECT_EQ(Load(parts).clips->num_clips(), 0);
}

TEST(HandleClips, Sample_AllocatesNothing) {
  GltfParts parts = BakedTube();
  const size_t clip = AddAnimation(&parts, "All");
  AddChannel(&parts, clip, 3, "translation", {0, 2}, {1.05f, 0, 0, 1.05f, 1, 0.5f});
  AddChannel(&parts, clip, 3, "rotation", {0, 1}, Joined(AboutZ(0), AboutZ(1)));
  AddChannel(&parts, clip, 3, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
  const Loaded loaded = Load(parts);
  const int right = loaded.rig->FindHandle("right");
  const int64_t before = AllocationCount();
  for (int i = 0; i < 10; ++i)
    (void)PlaceIn(loaded, 0, right, 0.1 * i);
  EXPECT_EQ(AllocationCount(), before);
}

}  // namespace
}  // namespace limber::test
