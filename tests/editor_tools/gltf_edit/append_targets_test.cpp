// A mesh that gets more morph targets still moves as it did before.
#include "gltf_edit/append_targets.h"

#include "animation/clip_shapes.h"
#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"

#include <gtest/gtest.h>

namespace limber::test {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSecondBarNode = 4;

// A bar with two targets, a second node and mesh of the same kind, and clips of their weights.
GltfParts MakeMorphingBars() {
  BarOptions options;
  options.has_targets = true;
  GltfParts parts = MakeAnimatedBar(options);
  parts.json["nodes"].push_back({{"name", "Other"}, {"mesh", 1}, {"skin", 0}});
  parts.json["meshes"].push_back(parts.json["meshes"][0]);
  parts.json["animations"].push_back({{"name", "Linear"}});
  AddChannel(&parts, 1, kBarMeshNode, "weights", {0, 1, 2}, {0, 0, 1, 0.5f, 0, 1});
  parts.json["animations"].push_back({{"name", "Spline"}});
  AddChannel(&parts, 2, kBarMeshNode, "weights", {0, 2},
             {0, 0, 0.1f, 0.2f, 1, -1,  //
              2, 1, 0.7f, 0.9f, 0, 0},
             "CUBICSPLINE");
  // One sampler that moves both meshes.
  parts.json["animations"].push_back({{"name", "Both"}});
  AddChannel(&parts, 3, kBarMeshNode, "weights", {0, 1}, {0, 1, 1, 0}, "STEP");
  Json second = parts.json["animations"][3]["channels"][0];
  second["target"]["node"] = kSecondBarNode;
  parts.json["animations"][3]["channels"].push_back(second);
  return parts;
}

bake::NewTarget TargetNamed(const std::string& name, size_t num_primitives) {
  bake::NewTarget target{name, {}};
  for (size_t p = 0; p < num_primitives; ++p) {
    target.primitives.emplace_back();
    target.primitives.back().positions.assign(3 * BarPositions().size(), 0.25f);
  }
  return target;
}

Result<Vector<uint8_t>> Append(const GltfFile& file, size_t num_primitives) {
  Result<bake::GltfPatch> patch = bake::GltfPatch::Begin(file);
  if (!patch.ok()) return patch.status();
  const Vector<bake::NewTarget> targets = {TargetNamed("a", num_primitives),
                                           TargetNamed("b", num_primitives),
                                           TargetNamed("c", num_primitives)};
  LIMBER_RETURN_IF_ERROR(bake::AppendTargets(file, 0, targets, &*patch));
  return patch->Finish(true);
}

GltfFile AppendTo(const GltfParts& parts) {
  const GltfFile file = GltfFile::Parse(parts.Glb(), "bars.glb").value();
  const auto bytes = Append(file, file.json()["meshes"][0]["primitives"].size());
  EXPECT_TRUE(bytes.ok()) << bytes.status().message();
  if (!bytes.ok()) return GltfFile::Parse(parts.Glb(), "bars.glb").value();
  return GltfFile::Parse(*bytes, "longer.glb").value();
}

// The mesh of a node at a moment of a clip.
bake::PointMatrix ShapeOf(const GltfFile& file, int clip_index, int node, double time) {
  const auto clip = ReadAnimationClip(file, clip_index);
  EXPECT_TRUE(clip.ok()) << clip.status().message();
  const auto shapes = bake::ClipShapes::Create(file, node);
  EXPECT_TRUE(shapes.ok()) << shapes.status().message();
  if (!clip.ok() || !shapes.ok()) return {};
  return shapes->ShapeAt(*clip, time, false)[0].positions;
}

TEST(AppendTargets, OldClips_MoveTheMeshAsBefore) {
  const GltfParts parts = MakeMorphingBars();
  const GltfFile source = GltfFile::Parse(parts.Glb(), "bars.glb").value();
  const GltfFile longer = AppendTo(parts);
  for (int clip = 0; clip < 4; ++clip) {
    for (const int node : {kBarMeshNode, kSecondBarNode}) {
      for (const double time : {0.0, 0.3, 1.0, 1.7}) {
        const bake::PointMatrix shape = ShapeOf(longer, clip, node, time);
        const bake::PointMatrix expected = ShapeOf(source, clip, node, time);
        ASSERT_EQ(shape.rows(), expected.rows());
        EXPECT_EQ(shape, expected) << clip << " " << node << " " << time;
      }
    }
  }
  EXPECT_NE(ShapeOf(source, 2, kBarMeshNode, 0.3), ShapeOf(source, 2, kBarMeshNode, 1.0));
}

TEST(AppendTargets, WeightsAndNames_AreAsLongAsTheTargets) {
  GltfParts parts = MakeMorphingBars();
  parts.json["nodes"][kBarMeshNode]["weights"] = {0.5, 0.25};
  const GltfFile longer = AppendTo(parts);
  const Json& mesh = longer.json()["meshes"][0];
  EXPECT_EQ(mesh["primitives"][0]["targets"].size(), 5u);
  EXPECT_EQ(mesh["weights"], Json({0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(mesh["extras"]["targetNames"], Json({"wide", "deep", "a", "b", "c"}));
  EXPECT_EQ(longer.json()["nodes"][kBarMeshNode]["weights"], Json({0.5, 0.25, 0.0, 0.0, 0.0}));
  EXPECT_EQ(longer.json()["meshes"][1], parts.json["meshes"][1]) << "the other mesh stays";
}

TEST(AppendTargets, UnnamedTargets_AreNumberedAsReadersDo) {
  GltfParts parts = MakeMorphingBars();
  parts.json["meshes"][0].erase("extras");
  EXPECT_EQ(AppendTo(parts).json()["meshes"][0]["extras"]["targetNames"],
            Json({"target_0", "target_1", "a", "b", "c"}));
}

TEST(AppendTargets, PrimitiveWithoutTargets_GetsOnesAtRest) {
  GltfParts parts = MakeMorphingBars();
  Json second = parts.json["meshes"][0]["primitives"][0];
  second.erase("targets");
  parts.json["meshes"][0]["primitives"].push_back(second);
  const GltfFile longer = AppendTo(parts);
  const auto shapes = bake::ClipShapes::Create(longer, kBarMeshNode);
  ASSERT_TRUE(shapes.ok()) << shapes.status().message();
  const bake::SkinnedPrimitive& primitive = shapes->mesh().primitives[1];
  ASSERT_EQ(primitive.targets.size(), 5u);
  EXPECT_EQ(primitive.targets[0].positions.cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(primitive.targets[4].positions.cwiseAbs().minCoeff(), 0.25);
}

TEST(AppendTargets, AnimationPointers_AreExtendedToo) {
  GltfParts parts = MakeMorphingBars();
  for (const char* pointer : {"/nodes/3/weights", "/meshes/0/weights"}) {
    Json& channel = parts.json["animations"][1]["channels"][0];
    channel["target"] = {{"path", "pointer"},
                         {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
    const GltfFile longer = AppendTo(parts);
    const Json& sampler = longer.json()["animations"][1]["samplers"][0];
    EXPECT_EQ(longer.json()["accessors"][sampler["output"].get<size_t>()]["count"], 15) << pointer;
  }
}

TEST(AppendTargets, OldOutputs_LeaveNothingBehind) {
  const GltfParts parts = MakeMorphingBars();
  const GltfFile longer = AppendTo(parts);
  // Three new targets, no accessor more for the three outputs that were replaced but one that is
  // still in use by the other mesh.
  EXPECT_EQ(longer.json()["accessors"].size(), parts.json["accessors"].size() + 3 + 1);
}

TEST(AppendTargets, WrongNumbersOfWeights_AreNamed) {
  const auto message = [](const GltfParts& parts) {
    const GltfFile file = GltfFile::Parse(parts.Glb(), "bars.glb").value();
    return Append(file, 1).status().message();
  };
  GltfParts node = MakeMorphingBars(), mesh = node, clip = node;
  node.json["nodes"][kBarMeshNode]["weights"] = {1.0};
  mesh.json["meshes"][0]["weights"] = "none";
  AddChannel(&clip, 1, kBarMeshNode, "weights", {0, 1}, {0, 0, 1});
  EXPECT_NE(message(node).find("nodes[3].weights"), std::string::npos) << message(node);
  EXPECT_NE(message(mesh).find("meshes[0].weights"), std::string::npos) << message(mesh);
  EXPECT_NE(message(clip).find("animations[1].channels[1]"), std::string::npos) << message(clip);
}

}  // namespace
}  // namespace limber::test
