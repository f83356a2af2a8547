// Weights that an artist painted come through to the baked character as they are.
#include "animation/painted_weights.h"

#include "bake/bake.h"
#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"
#include "import/import_gltf.h"
#include "rig/rig.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::test {
namespace {

using bake::PaintedWeights;
using bake::RawCharacter;

struct Painted {
  GltfFile file;
  RawCharacter raw;
};

Painted Open(const GltfParts& parts) {
  Result<GltfFile> file = GltfFile::Parse(parts.Glb(), "bar.glb");
  EXPECT_TRUE(file.ok()) << file.status().message();
  Result<RawCharacter> raw = bake::ImportGltf(*file);
  EXPECT_TRUE(raw.ok()) << raw.status().message();
  return {std::move(file).value(), std::move(raw).value()};
}

BarOptions WithTargets() {
  BarOptions options;
  options.has_targets = true;
  return options;
}

TEST(WeightsOfSkin, AreTheJoints_AndEachIsHeldByAVertexThatFollowsIt) {
  BarOptions scaled = WithTargets();  // centimetres and another up axis, as FBX files bring
  scaled.to_mesh.linear() =
      100 * Eigen::AngleAxisd(1.57, Eigen::Vector3d::UnitX()).toRotationMatrix();
  BarOptions two_sets = WithTargets(), unnormalised = WithTargets();
  two_sets.two_sets = true;
  unnormalised.weight_sum = 0.25f;
  const Vector<Eigen::Vector3d> positions = BarPositions();
  for (const BarOptions& options : {WithTargets(), scaled, two_sets, unnormalised}) {
    const Painted bar = Open(MakeAnimatedBar(options));
    const auto painted = bake::WeightsOfSkin(bar.file, bar.raw);
    ASSERT_TRUE(painted.ok()) << painted.status().message();
    ASSERT_EQ(painted->handles.size(), 2u);
    EXPECT_EQ(painted->handles[0].name, "root");
    EXPECT_EQ(painted->handles[1].name, "middle");
    EXPECT_EQ(painted->handles[1].node, kBarMiddleNode);
    for (size_t v = 0; v < positions.size(); ++v) {
      const auto row = static_cast<Eigen::Index>(v);
      EXPECT_NEAR(painted->weights(row, 1), MiddleWeight(positions[v]), 1e-6);
      EXPECT_NEAR(painted->weights.row(row).sum(), 1, 1e-6);
    }
    // The root stands at y = 0, where vertices follow it alone; the middle at y = 1, and the
    // nearest vertices that follow it by nine tenths are further up.
    const Eigen::Vector3d root = positions[*painted->handles[0].source_vertex];
    const Eigen::Vector3d middle = positions[*painted->handles[1].source_vertex];
    EXPECT_NEAR(root.y(), 0, 1e-6);
    EXPECT_GE(MiddleWeight(middle), 0.9);
    for (const Eigen::Vector3d& other : positions) {
      if (MiddleWeight(other) >= 0.9) {
        EXPECT_GE(other.y(), middle.y() - 1e-6);
      }
    }
  }
}

// What the game skins with is what was painted, in single precision.
TEST(WeightsOfSkin, ComeThroughABake) {
  Painted bar = Open(MakeAnimatedBar(WithTargets()));
  auto painted = bake::WeightsOfSkin(bar.file, bar.raw);
  ASSERT_TRUE(painted.ok());
  bar.raw.painted_weights = painted->weights;
  auto baked = bake::Bake(bar.raw, painted->handles, {}, {});
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  EXPECT_TRUE(baked->weights.handles.empty()) << "nothing was computed";
  const Vector<Eigen::Vector3d> positions = BarPositions();
  for (size_t d = 0; d < positions.size(); ++d) {
    const size_t v = baked->mesh.solve_vertex[d];
    EXPECT_NEAR(baked->mesh.weights[2 * v + 1], MiddleWeight(positions[d]), 1e-6);
  }
  EXPECT_TRUE(Rig::Create("bar", baked->tables, baked->mesh).ok());
}

TEST(WeightsOfSkin, WithoutASkin_SaysSo) {
  GltfParts parts = MakeAnimatedBar(WithTargets());
  parts.json["nodes"][kBarMeshNode].erase("skin");
  const Painted bar = Open(parts);
  const auto painted = bake::WeightsOfSkin(bar.file, bar.raw);
  EXPECT_EQ(painted.status().code(), StatusCode::kNotFound);
  EXPECT_NE(painted.status().message().find("no skin"), std::string::npos);
}

TEST(WeightsOfSkin, AJointThatMovesNothing_IsLeftOutWithAWarning) {
  GltfParts parts = MakeAnimatedBar(WithTargets());
  auto& json = parts.json;
  const auto idle = json["nodes"].size();
  json["nodes"].push_back({{"name", "idle"}});
  json["nodes"][kBarMiddleNode]["children"].push_back(idle);
  json["skins"][0]["joints"].push_back(idle);
  const Vector<float> identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  Vector<float> bind;
  for (int joint = 0; joint < 3; ++joint)
    bind.insert(bind.end(), identity.begin(), identity.end());
  json["skins"][0]["inverseBindMatrices"] = parts.AddFloats(bind, "MAT4");
  const Painted bar = Open(parts);
  const auto painted = bake::WeightsOfSkin(bar.file, bar.raw);
  ASSERT_TRUE(painted.ok()) << painted.status().message();
  EXPECT_EQ(painted->handles.size(), 2u);
  ASSERT_EQ(painted->warnings.size(), 1u);
  EXPECT_NE(painted->warnings[0].find("no handle: idle"), std::string::npos)
      << painted->warnings[0];
}

// Two handles on the bar, red and green; blue is nobody's.
GltfParts ColoredBar() {
  GltfParts parts = MakeAnimatedBar(WithTargets());
  Vector<float> colors;
  for (const Eigen::Vector3d& position : BarPositions()) {
    const auto up = static_cast<float>(MiddleWeight(position));
    colors.insert(colors.end(), {1 - up, up, 0.7f});
  }
  parts.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      parts.AddFloats(colors, "VEC3");
  return parts;
}

Vector<bake::HandleSpec> Handles(int count) {
  Vector<bake::HandleSpec> handles(static_cast<size_t>(count));
  for (size_t h = 0; h < handles.size(); ++h) {
    handles[h].name = "h" + std::to_string(h);
    handles[h].source_vertex = h == 0 ? 0 : static_cast<uint32_t>(BarPositions().size() - h);
  }
  return handles;
}

TEST(WeightsOfColors, AreChannelsInTheOrderOfTheHandles) {
  Painted bar = Open(ColoredBar());
  const auto painted = bake::WeightsOfColors(bar.file, bar.raw, Handles(2));
  ASSERT_TRUE(painted.ok()) << painted.status().message();
  const Vector<Eigen::Vector3d> positions = BarPositions();
  for (size_t v = 0; v < positions.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    EXPECT_NEAR(painted->weights(row, 0), 1 - MiddleWeight(positions[v]), 1e-6);
    EXPECT_NEAR(painted->weights(row, 1), MiddleWeight(positions[v]), 1e-6);
  }
  bar.raw.painted_weights = painted->weights;
  EXPECT_TRUE(bake::Bake(bar.raw, painted->handles, {}, {}).ok());
}

TEST(WeightsOfColors, AHandleWithoutAChannel_IsNamed) {
  const Painted bar = Open(ColoredBar());
  const auto five = bake::WeightsOfColors(bar.file, bar.raw, Handles(5));
  EXPECT_FALSE(five.ok()) << "alpha is missing, and so is COLOR_1";
  const Painted plain = Open(MakeAnimatedBar(WithTargets()));
  const auto none = bake::WeightsOfColors(plain.file, plain.raw, Handles(2));
  EXPECT_EQ(none.status().code(), StatusCode::kNotFound);
  EXPECT_NE(none.status().message().find("'h0'"), std::string::npos) << none.status().message();
}

TEST(PaintedWeights, ThatCannotBe_AreRefused) {
  const Painted bar = Open(ColoredBar());
  const auto painted = bake::WeightsOfColors(bar.file, bar.raw, Handles(2));
  ASSERT_TRUE(painted.ok());
  const auto bake_with = [&](const Eigen::MatrixXd& weights) {
    RawCharacter raw = bar.raw;
    raw.painted_weights = weights;
    return bake::Bake(raw, painted->handles, {}, {}).status();
  };
  Eigen::MatrixXd weights = painted->weights;
  EXPECT_EQ(bake_with(weights.leftCols(1)).code(), StatusCode::kInvalidArgument);
  weights(3, 1) = -0.5;
  EXPECT_EQ(bake_with(weights).code(), StatusCode::kInvalidArgument);
  weights(3, 1) = std::nan("");
  EXPECT_EQ(bake_with(weights).code(), StatusCode::kInvalidArgument);
  weights = painted->weights;
  weights.col(1).setZero();
  EXPECT_EQ(bake_with(weights).code(), StatusCode::kDegenerate);
}

// Vertices that nobody painted follow as their neighbours do.
TEST(PaintedWeights, EmptyRows_AreFilledFromAround) {
  Painted bar = Open(ColoredBar());
  const auto painted = bake::WeightsOfColors(bar.file, bar.raw, Handles(2));
  ASSERT_TRUE(painted.ok());
  bar.raw.painted_weights = painted->weights;
  const Vector<Eigen::Vector3d> positions = BarPositions();
  for (size_t v = 0; v < positions.size(); ++v) {
    if (std::abs(positions[v].y() - 1) < 0.2)
      bar.raw.painted_weights.row(static_cast<Eigen::Index>(v)).setZero();
  }
  const auto baked = bake::Bake(bar.raw, painted->handles, {}, {});
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  for (size_t v = 0; v < baked->mesh.num_solve_vertices; ++v) {
    const float* row = baked->mesh.weights.data() + 2 * v;
    EXPECT_NEAR(row[0] + row[1], 1, 1e-6);
    EXPECT_GE(std::min(row[0], row[1]), 0);
  }
}

}  // namespace
}  // namespace limber::test
