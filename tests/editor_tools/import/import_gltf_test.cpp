#include "import/import_gltf.h"

#include "clips/node_transforms.h"
#include "core/vector.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

// A mesh whose numbers are all zeros that no bytes stand for: enough to look at nodes.
Json Scene(const Json& nodes) {
  const Json primitive = {{"attributes", {{"POSITION", 0}}},
                          {"targets", Json::array({{{"POSITION", 0}}})}};
  return {{"asset", {{"version", "2.0"}}},
          {"nodes", nodes},
          {"accessors", Json::array({{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}})},
          {"meshes", Json::array({{{"primitives", Json::array({primitive})}}})}};
}

Result<bake::RawCharacter> Import(const Json& root, const bake::ImportOptions& options = {}) {
  const std::string text = root.dump();
  const auto file =
      GltfFile::Parse({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "scene.gltf");
  if (!file.ok()) return file.status();
  return bake::ImportGltf(*file, options);
}

bake::ImportOptions Node(const std::string& name) {
  bake::ImportOptions options;
  options.node = name;
  return options;
}

TEST(ImportGltf, HandleMarks_AreBroughtIntoMeshSpace) {
  // The mesh: moved by 10, turned by a quarter about z, twice as large. The handle hangs below a
  // node with a matrix elsewhere in the hierarchy.
  const double half = std::sqrt(0.5);
  const Json nodes = {
      {{"name", "body"}, {"mesh", 0}, {"scale", {2, 2, 2}}},
      {{"name", "turned"},
       {"children", {0}},
       {"translation", {10, 0, 0}},
       {"rotation", {0, 0, half, half}}},
      {{"name", "far"},
       {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 0, 0, 1}},
       {"children", {3, 4}}},
      {{"name", "tail"}, {"translation", {6, 8, 2}}, {"extras", {{"limber_handle", true}}}},
      {{"name", "knee"}, {"extras", {{"limber_handle", {{"pinned", false}}}}}},
      {{"name", "other"}, {"extras", {{"limber_handle", false}}}}};
  const auto raw = Import(Scene(nodes));
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  ASSERT_EQ(raw->marked_handles.size(), 2u);
  const bake::HandleSpec& tail = raw->marked_handles[0];
  EXPECT_EQ(tail.name, "tail");
  EXPECT_TRUE(tail.pinned);
  EXPECT_EQ(tail.node, 3);
  // World (10, 8, 2), from the body (0, 8, 2); turned back (8, 0, 2), halved.
  EXPECT_NEAR(tail.position->x, 4, 1e-6);
  EXPECT_NEAR(tail.position->y, 0, 1e-6);
  EXPECT_NEAR(tail.position->z, 1, 1e-6);
  EXPECT_FALSE(raw->marked_handles[1].pinned);
  EXPECT_EQ(raw->node, 0);
  EXPECT_EQ(raw->name, "body");
}

TEST(ImportGltf, BaseMesh_IsAShapeUnlessToldOtherwise) {
  const Json root = Scene({{{"mesh", 0}}});
  EXPECT_EQ(Import(root)->shape_names, (Vector<std::string>{"base", "target_0"}));
  bake::ImportOptions options;
  options.include_base = false;
  EXPECT_EQ(Import(root, options)->shape_names, (Vector<std::string>{"target_0"}));
}

TEST(ImportGltf, SeveralCandidates_AreListedAndChosenByNameOrNumber) {
  const Json root =
      Scene({{{"mesh", 0}, {"name", "left"}}, {{"name", "x"}}, {{"mesh", 0}, {"name", "right"}}});
  const Status status = Import(root).status();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  for (const char* part : {"--node", "\"left\" (0)", "\"right\" (2)"}) {
    EXPECT_NE(status.message().find(part), std::string::npos) << status.message();
  }
  EXPECT_EQ(Import(root, Node("right"))->node, 2);
  EXPECT_EQ(Import(root, Node("0"))->node, 0);
  EXPECT_EQ(Import(root, Node("1")).status().code(), StatusCode::kNotFound) << "has no mesh";
  EXPECT_EQ(Import(root, Node("rihgt")).status().code(), StatusCode::kNotFound);
  const Json twins = Scene({{{"mesh", 0}, {"name", "a"}}, {{"mesh", 0}, {"name", "a"}}});
  EXPECT_EQ(Import(twins, Node("a")).status().code(), StatusCode::kInvalidArgument);
}

TEST(ImportGltf, BadMarks_NameTheNode) {
  for (const Json& mark : {Json("yes"), Json(2), Json({{"pinned", 1}})}) {
    const auto raw =
        Import(Scene({{{"mesh", 0}}, {{"name", "paw"}, {"extras", {{"limber_handle", mark}}}}}));
    EXPECT_EQ(raw.status().code(), StatusCode::kMalformed) << mark;
    EXPECT_NE(raw.status().message().find("paw"), std::string::npos);
  }
  const auto flat = Import(Scene({{{"mesh", 0}, {"scale", {1, 0, 1}}},
                                  {{"name", "paw"}, {"extras", {{"limber_handle", true}}}}}));
  EXPECT_EQ(flat.status().code(), StatusCode::kMalformed) << "no inverse";
}

TEST(WorldTransforms, LongChain_NeedsNoStack) {
  Json nodes = Json::array({{{"mesh", 0}}});
  constexpr int kLength = 20000;
  for (int n = 1; n <= kLength; ++n) {
    nodes.push_back({{"translation", {1, 0, 0}}, {"children", Json::array({n - 1})}});
  }
  const std::string text = Scene(nodes).dump();
  const auto file =
      GltfFile::Parse({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "chain");
  ASSERT_TRUE(file.ok()) << file.status().message();
  EXPECT_EQ(WorldTransforms(*file)[0](0, 3), kLength);
}

}  // namespace
}  // namespace limber::test
