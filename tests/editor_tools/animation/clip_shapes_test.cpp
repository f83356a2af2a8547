// Skinned shapes of a bar against closed forms, and against each other.
#include "animation/clip_shapes.h"

#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::test {
namespace {

using bake::PointMatrix;
using bake::PosedPrimitive;
using Json = nlohmann::ordered_json;

constexpr double kRounding = 2e-6;  // the files hold single precision

// A bar's file with its clip and its shapes, ready to be asked.
struct OpenBar {
  explicit OpenBar(const GltfParts& parts)
      : file(GltfFile::Parse(parts.Glb(), "bar.glb").value()),
        clip(ReadAnimationClip(file, 0).value()),
        shapes(bake::ClipShapes::Create(file, kBarMeshNode).value()) {}

  PosedPrimitive At(double time, bool in_place = false) const {
    return shapes.ShapeAt(clip, time, in_place)[0];
  }

  GltfFile file;
  AnimationClip clip;
  bake::ClipShapes shapes;
};

Eigen::Matrix3d Turn(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

// Linear blend skinning of the bar, by hand.
Eigen::Vector3d BentPosition(const Eigen::Vector3d& p, double angle) {
  const Eigen::Vector3d joint(0, 1, 0);
  const double weight = MiddleWeight(p);
  return (1 - weight) * p + weight * (joint + Turn(angle) * (p - joint));
}

double LargestDifference(const PointMatrix& a, const PointMatrix& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

GltfParts BarWith(const BarOptions& options) {
  return MakeAnimatedBar(options);
}

BarOptions TurnedOptions() {
  BarOptions options;
  options.to_mesh = Eigen::Scaling(100.0) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()) *
                    Eigen::Translation3d(0.1, 0.2, 0.3);
  return options;
}

TEST(ClipShapes, BentJoint_IsTheBlendOfTwoRigidMotions) {
  const OpenBar bar(MakeAnimatedBar());
  const Vector<Eigen::Vector3d> rest = BarPositions();
  int num_blended = 0;
  for (const double time : {0.0, 0.25, 0.5, 1.0}) {
    const PosedPrimitive posed = bar.At(time);
    for (size_t v = 0; v < rest.size(); ++v) {
      const Eigen::Vector3d expected = BentPosition(rest[v], kBendAngle * time);
      const auto row = static_cast<Eigen::Index>(v);
      EXPECT_LT((posed.positions.row(row).transpose() - expected).norm(), kRounding) << v;
      const double weight = MiddleWeight(rest[v]);
      num_blended += weight > 0 && weight < 1 ? 1 : 0;
    }
  }
  EXPECT_GT(num_blended, 4);
}

TEST(ClipShapes, RigidlyMovedVertices_KeepTheirDistances) {
  const OpenBar bar(MakeAnimatedBar());
  const PointMatrix rest = bar.At(0).positions, bent = bar.At(1).positions;
  const Eigen::Index last = rest.rows() - 1, near_end = rest.rows() - 12;
  EXPECT_NEAR((bent.row(last) - bent.row(near_end)).norm(),
              (rest.row(last) - rest.row(near_end)).norm(), kRounding);
  EXPECT_GT((bent.row(last) - rest.row(last)).norm(), 0.5);
}

TEST(ClipShapes, NormalsInTheBlend_TurnByHalfTheAngle) {
  // Half of both joints: (1 + R) / 2 is cos(a/2) times the turn by a/2 across z, and 1 along it;
  // the inverse transpose divides by the cosine.
  const OpenBar bar(MakeAnimatedBar());
  const PosedPrimitive rest = bar.At(0), bent = bar.At(1);
  const double half = kBendAngle / 2;
  int num_checked = 0;
  for (Eigen::Index v = 0; v < rest.positions.rows(); ++v) {
    if (std::abs(rest.positions(v, 1) - 1) > 1e-6) continue;
    Eigen::Vector3d expected = Turn(half) * rest.normals.row(v).transpose();
    expected.head<2>() /= std::cos(half);
    EXPECT_LT((bent.normals.row(v).transpose() - expected.normalized()).norm(), kRounding);
    ++num_checked;
  }
  EXPECT_EQ(num_checked, 4);
}

TEST(ClipShapes, BindPose_DisplacesNothing) {
  for (const BarOptions& options : {BarOptions(), TurnedOptions()}) {
    const OpenBar bar(BarWith(options));
    const PosedPrimitive posed = bar.At(0);
    const bake::SkinnedPrimitive& rest = bar.shapes.mesh().primitives[0];
    const double size = rest.positions.cwiseAbs().maxCoeff();
    EXPECT_LT(LargestDifference(posed.positions, rest.positions), kRounding * size);
    EXPECT_LT(LargestDifference(posed.normals, rest.normals), kRounding);
  }
}

TEST(ClipShapes, ScaledAndTurnedBind_GivesTheSameShapes) {
  const BarOptions turned = TurnedOptions();
  const OpenBar plain(MakeAnimatedBar()), other(BarWith(turned));
  const PosedPrimitive a = plain.At(0.7), b = other.At(0.7);
  for (Eigen::Index v = 0; v < a.positions.rows(); ++v) {
    const Eigen::Vector3d expected = turned.to_mesh * a.positions.row(v).transpose().eval();
    EXPECT_LT((b.positions.row(v).transpose() - expected).norm(), 100 * kRounding);
    const Eigen::Vector3d normal =
        (turned.to_mesh.linear() * a.normals.row(v).transpose()).normalized();
    EXPECT_LT((b.normals.row(v).transpose() - normal).norm(), kRounding);
  }
}

// Joints in the other order, and the middle one not in its bind pose when nothing is animated.
TEST(ClipShapes, RestOutOfTheBindPose_IsMeasuredFromTheTopmostJoint) {
  GltfParts parts = MakeAnimatedBar();
  Json& attributes = parts.json["meshes"][0]["primitives"][0]["attributes"];
  Vector<uint16_t> joints;
  for (const Eigen::Vector3d& p : BarPositions())
    joints.insert(joints.end(), {1, static_cast<uint16_t>(MiddleWeight(p) > 0 ? 0 : 1), 1, 1});
  attributes["JOINTS_0"] = parts.AddShorts(joints, "VEC4");
  parts.json["skins"][0]["joints"] = {kBarMiddleNode, kBarRootNode};
  Vector<float> matrices(32, 0);
  for (size_t i = 0; i < 32; i += 16) {
    for (const size_t diagonal : {0, 5, 10, 15})
      matrices[i + diagonal] = 1;
  }
  matrices[13] = -1;  // down from the middle
  parts.json["skins"][0]["inverseBindMatrices"] = parts.AddFloats(matrices, "MAT4");
  parts.json["nodes"][kBarMiddleNode]["rotation"] = {0.6, 0.0, 0.0, 0.8};
  EXPECT_LT(LargestDifference(OpenBar(parts).At(0.6).positions,
                              OpenBar(MakeAnimatedBar()).At(0.6).positions),
            kRounding);
}

TEST(ClipShapes, FurtherSetsAndUnnormalisedWeights_GiveTheSameShape) {
  const PointMatrix expected = OpenBar(MakeAnimatedBar()).At(0.6).positions;
  BarOptions two_sets, heavy;
  two_sets.two_sets = true;
  heavy.weight_sum = 3;
  for (const BarOptions& options : {two_sets, heavy}) {
    EXPECT_LT(LargestDifference(OpenBar(BarWith(options)).At(0.6).positions, expected), kRounding);
  }
}

TEST(ClipShapes, MorphTargets_AreAddedBeforeTheBones) {
  BarOptions options;
  options.has_targets = true;
  GltfParts parts = BarWith(options);
  parts.json["nodes"][kBarMeshNode]["weights"] = {0.0, 1.0};
  AddChannel(&parts, 0, kBarMeshNode, "weights", {0, 1}, {0, 0, 1, 0});
  const OpenBar animated(parts);
  // At half time: "wide" by a half, so that x is 1.25 times as far out.
  const PointMatrix posed = animated.At(0.5).positions;
  const Vector<Eigen::Vector3d> rest = BarPositions();
  for (size_t v = 0; v < rest.size(); ++v) {
    const Eigen::Vector3d morphed(1.25 * rest[v].x(), rest[v].y(), rest[v].z());
    EXPECT_LT((posed.row(static_cast<Eigen::Index>(v)).transpose() -
               BentPosition(morphed, kBendAngle / 2))
                  .norm(),
              kRounding);
  }
}

TEST(ClipShapes, WeightsAtRest_AreTheNodesBeforeTheMeshs) {
  BarOptions options;
  options.has_targets = true;
  GltfParts parts = BarWith(options);
  parts.json["meshes"][0]["weights"] = {1.0, 0.0};
  const Vector<Eigen::Vector3d> rest = BarPositions();
  EXPECT_NEAR(OpenBar(parts).At(0).positions(0, 0), 1.5 * rest[0].x(), kRounding);
  parts.json["nodes"][kBarMeshNode]["weights"] = {0.0, 1.0};
  const PointMatrix posed = OpenBar(parts).At(0).positions;
  EXPECT_NEAR(posed(0, 0), rest[0].x(), kRounding);
  EXPECT_NEAR(posed(0, 2), 1.5 * rest[0].z(), kRounding);
}

TEST(ClipShapes, RootMotion_IsInTheShapeUnlessHeldInPlace) {
  GltfParts parts = MakeAnimatedBar();
  // In the armature, which is turned by a quarter about y: its x is the world's -z.
  AddChannel(&parts, 0, kBarRootNode, "translation", {0, 1}, {0, 0, 0, 3, 0.5, 2});
  const OpenBar bar(parts);
  const PointMatrix still = OpenBar(MakeAnimatedBar()).At(1).positions;
  const PointMatrix moved = bar.At(1).positions, held = bar.At(1, true).positions;
  PointMatrix expected = still;
  expected.rowwise() += Eigen::RowVector3d(3, 0.5, 2);
  EXPECT_LT(LargestDifference(moved, expected), kRounding);
  expected = still;
  expected.col(1).array() += 0.5;
  EXPECT_LT(LargestDifference(held, expected), kRounding);
}

TEST(ClipShapes, StretchedJoint_KeepsNormalsUprightOnTheSurface) {
  GltfParts parts = MakeAnimatedBar();
  AddChannel(&parts, 0, kBarMiddleNode, "scale", {0}, {4, 1, 1});
  const PosedPrimitive posed = OpenBar(parts).At(0);
  const PosedPrimitive rest = OpenBar(MakeAnimatedBar()).At(0);
  // n' ~ (n_x / 4, n_y, n_z), and not (4 n_x, ...).
  const Eigen::Index last = posed.normals.rows() - 1;
  Eigen::RowVector3d expected = rest.normals.row(last);
  expected.x() /= 4;
  EXPECT_LT((posed.normals.row(last) - expected.normalized()).norm(), kRounding);
}

TEST(ClipShapes, VertexWithoutWeight_FollowsTheRootAndIsCounted) {
  BarOptions weightless;
  weightless.weight_sum = 0;
  const OpenBar bar(BarWith(weightless));
  EXPECT_LT(LargestDifference(bar.At(1).positions, bar.At(0).positions), kRounding);
  ASSERT_EQ(bar.shapes.mesh().warnings.size(), 1u);
  EXPECT_NE(bar.shapes.mesh().warnings[0].find("68 vertices"), std::string::npos)
      << bar.shapes.mesh().warnings[0];
}

TEST(ClipDeforms, OnlyWhatMovesAJointOrAWeight_Counts) {
  BarOptions options;
  options.has_targets = true;
  GltfParts parts = BarWith(options);
  parts.json["nodes"].push_back({{"name", "lamp"}});
  const auto add_clip = [&parts](int node, const char* path, const Vector<float>& values) {
    parts.json["animations"].push_back(nlohmann::ordered_json::object());
    AddChannel(&parts, parts.json["animations"].size() - 1, node, path, {0, 1}, values);
  };
  add_clip(4, "translation", {0, 0, 0, 1, 1, 1});  // beside the skeleton
  add_clip(kBarMeshNode, "translation", {0, 0, 0, 1, 1, 1});
  add_clip(kBarMeshNode, "weights", {0, 0, 0, 0});
  add_clip(0, "translation", {0, 0, 0, 1, 1, 1});  // above the skeleton
  add_clip(kBarMeshNode, "weights", {0, 0, 0, 0.5f});
  const GltfFile file = GltfFile::Parse(parts.Glb(), "bar.glb").value();
  const Vector<bool> expected = {true, false, false, false, true, true};
  for (size_t a = 0; a < expected.size(); ++a) {
    const auto clip = ReadAnimationClip(file, static_cast<int>(a));
    ASSERT_TRUE(clip.ok()) << clip.status().message();
    EXPECT_EQ(bake::ClipDeforms(file, *clip, kBarMeshNode), expected[a]) << a;
  }
}

}  // namespace
}  // namespace limber::test
