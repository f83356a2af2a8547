// Moments of a clip as morph targets of the file that comes out.
#include "animation/pack_clip.h"

#include "animation/clip_moments.h"
#include "animation/clip_shapes.h"
#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"
#include "load/gltf_mesh.h"
#include "support/gltf_validator.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using bake::PackClipOptions;
using Json = nlohmann::ordered_json;

constexpr double kRounding = 2e-6;

PackClipOptions AtTimes(Vector<double> times) {
  PackClipOptions options;
  options.times = std::move(times);
  return options;
}

class PackClip : public testing::Test {
 protected:
  fs::path Path(const char* name) const { return folder_.path() / name; }

  fs::path Write(const GltfParts& parts, const char* name) const {
    parts.Write(Path(name));
    return Path(name);
  }

  // Packs the parts; fails the test where that fails.
  bake::PackClipSummary Pack(const GltfParts& parts, const PackClipOptions& options) const {
    auto summary = bake::PackClip(Write(parts, "in.glb"), options, Path("out.glb"));
    EXPECT_TRUE(summary.ok()) << summary.status().message();
    return summary.ok() ? *summary : bake::PackClipSummary();
  }

  GltfFile Open(const char* name) const { return GltfFile::Open(Path(name)).value(); }

  TemporaryFolder folder_;
};

bake::PosedPrimitive ShapeOf(const GltfFile& file, int animation, double time) {
  const auto clip = ReadAnimationClip(file, animation);
  EXPECT_TRUE(clip.ok()) << clip.status().message();
  const auto shapes = bake::ClipShapes::Create(file, kBarMeshNode);
  EXPECT_TRUE(shapes.ok()) << shapes.status().message();
  if (!clip.ok() || !shapes.ok()) return {};
  return shapes->ShapeAt(*clip, time, false)[0];
}

TEST_F(PackClip, EachMoment_IsATargetThatHasTheSkinnedShape) {
  const bake::PackClipSummary summary = Pack(MakeAnimatedBar(), AtTimes({0, 0.1, 1}));
  EXPECT_EQ(summary.shape_names, (Vector<std::string>{"Bend@0", "Bend@0.1", "Bend@1"}));
  EXPECT_EQ(summary.node, "Bar");
  EXPECT_EQ(summary.clip_seconds, 1);
  const GltfFile source = Open("in.glb"), packed = Open("out.glb");
  const auto mesh = ReadMorphMesh(packed, 0);
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_EQ(mesh->target_names, summary.shape_names);
  const Vector<double> times = {0, 0.1, 1};
  for (size_t t = 0; t < times.size(); ++t) {
    const bake::PointMatrix expected = ShapeOf(source, 0, times[t]).positions;
    for (uint32_t v = 0; v < mesh->num_vertices(); ++v) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(mesh->positions[v][axis] + mesh->targets[t][v][axis], expected(v, axis),
                    kRounding);
      }
    }
  }
}

TEST_F(PackClip, BindPose_DisplacesByRoundingOnlyAndIsRemarkedOn) {
  const bake::PackClipSummary summary = Pack(MakeAnimatedBar(), AtTimes({0, 0.5}));
  const auto mesh = ReadMorphMesh(Open("out.glb"), 0);
  for (const Vec3& offset : mesh->targets[0]) {
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(offset[axis], 0, kRounding);
  }
  ASSERT_EQ(summary.warnings.size(), 1u);
  EXPECT_NE(summary.warnings[0].find("Bend@0"), std::string::npos) << summary.warnings[0];
}

TEST_F(PackClip, NormalTargets_TurnTheNormals) {
  Pack(MakeAnimatedBar(), AtTimes({1}));
  const GltfFile packed = Open("out.glb");
  // The packed file with full weight and no skin shows what a viewer shows of the target alone.
  const auto shapes = bake::ClipShapes::Create(packed, kBarMeshNode);
  ASSERT_TRUE(shapes.ok()) << shapes.status().message();
  const double weight = 1;
  const auto morphed = PosePrimitive(shapes->mesh().primitives[0], {&weight, 1}, {});
  const auto skinned = ShapeOf(Open("in.glb"), 0, 1);
  EXPECT_LT((morphed.normals - skinned.normals).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_GT((skinned.normals - shapes->mesh().primitives[0].normals).norm(), 1);
}

TEST_F(PackClip, RestOfTheFile_IsEqual) {
  Pack(MakeAnimatedBar(), AtTimes({0.5, 1}));
  const Json source = Open("in.glb").json();
  Json packed = Open("out.glb").json();
  packed["meshes"][0]["primitives"][0].erase("targets");
  packed["meshes"][0].erase("extras");
  for (const char* section : {"accessors", "bufferViews"}) {
    while (packed[section].size() > source[section].size())
      packed[section].erase(packed[section].size() - 1);
  }
  packed["buffers"] = source["buffers"];
  EXPECT_EQ(nlohmann::json::diff(nlohmann::json::parse(source.dump()),
                                 nlohmann::json::parse(packed.dump())),
            nlohmann::json::array());
}

TEST_F(PackClip, SameInput_GivesTheSameBytes) {
  PackClipOptions options;
  options.count = 5;
  Pack(MakeAnimatedBar(), options);
  const auto again = bake::PackClip(Path("in.glb"), options, Path("again.glb"));
  ASSERT_TRUE(again.ok());
  const auto bytes = [this](const char* name) {
    std::ifstream stream(Path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_GT(bytes("out.glb").size(), 1000u);
  EXPECT_EQ(bytes("out.glb"), bytes("again.glb"));
}

TEST_F(PackClip, PackedAgain_KeepsTheFirstTargetsAndTheirNames) {
  Pack(MakeAnimatedBar(), AtTimes({0.5}));
  const auto summary = bake::PackClip(Path("out.glb"), AtTimes({1}), Path("more.glb"));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->num_old_targets, 1u);
  const auto once = ReadMorphMesh(Open("out.glb"), 0), twice = ReadMorphMesh(Open("more.glb"), 0);
  EXPECT_EQ(twice->target_names, (Vector<std::string>{"Bend@0.5", "Bend@1"}));
  EXPECT_EQ(twice->targets[0], once->targets[0]);
  const auto same = bake::PackClip(Path("out.glb"), AtTimes({0.5}), Path("same.glb"));
  EXPECT_EQ(same.status().code(), StatusCode::kInvalidArgument);
  EXPECT_NE(same.status().message().find("Bend@0.5"), std::string::npos);
}

TEST_F(PackClip, MorphAnimationWithoutASkin_BecomesShapes) {
  BarOptions bar;
  bar.has_targets = true;
  GltfParts parts = MakeAnimatedBar(bar);
  parts.json["nodes"][kBarMeshNode].erase("skin");
  AddChannel(&parts, 0, kBarMeshNode, "weights", {0, 1}, {0, 0, 1, 0.5f});
  const bake::PackClipSummary summary = Pack(parts, AtTimes({0.5}));
  EXPECT_EQ(summary.num_old_targets, 2u);
  const auto mesh = ReadMorphMesh(Open("out.glb"), 0);
  ASSERT_EQ(mesh->targets.size(), 3u);
  for (uint32_t v = 0; v < mesh->num_vertices(); ++v) {
    EXPECT_NEAR(mesh->targets[2][v].x, 0.5 * mesh->targets[0][v].x, kRounding);
    EXPECT_NEAR(mesh->targets[2][v].z, 0.25 * mesh->targets[1][v].z, kRounding);
  }
}

TEST_F(PackClip, GlbAndGltf_AreCleanToTheValidator) {
  const ValidatorState state = FindGltfValidator(folder_.path());
  if (state == ValidatorState::kMissing) {
    GTEST_SKIP() << "no Khronos validator here: npm install --prefix tests";
  }
  ASSERT_EQ(state, ValidatorState::kReady) << "the validator must refuse a bad file";
  BarOptions bar;
  bar.has_targets = true;
  GltfParts parts = MakeAnimatedBar(bar);
  parts.json["nodes"][kBarMeshNode].erase("translation");  // a remark of its own
  AddChannel(&parts, 0, kBarMeshNode, "weights", {0, 1}, {0, 0, 1, 0.5f});
  EXPECT_TRUE(IsValidGltf(Write(parts, "in.glb")));
  // A second primitive, of points and without targets, which only Limber forgives.
  Json points = parts.json["meshes"][0]["primitives"][0];
  points.erase("targets");
  points.erase("indices");
  points["mode"] = 0;
  parts.json["meshes"][0]["primitives"].push_back(points);
  Pack(parts, AtTimes({0.25, 1}));
  EXPECT_TRUE(IsValidGltf(Path("out.glb")));
  const auto text = bake::PackClip(Path("in.glb"), AtTimes({0.25, 1}), Path("out.gltf"));
  ASSERT_TRUE(text.ok()) << text.status().message();
  EXPECT_TRUE(IsValidGltf(Path("out.gltf")));
  const GltfFile packed = Open("out.gltf");
  for (const Json& primitive : packed.json()["meshes"][0]["primitives"])
    EXPECT_EQ(primitive["targets"].size(), 4u);
}

TEST_F(PackClip, RobotsHand_IsPackedFromItsOwnFile) {
  const fs::path data = SharedDataFolder();
  if (data.empty()) GTEST_SKIP() << "no shared data folder here (LIMBER_DATA_DIR)";
  PackClipOptions options;
  options.clip = "ThumbsUp";
  options.node = "HandR_1";
  options.count = 4;
  const auto summary =
      bake::PackClip(data / "gltf_samples" / "RobotExpressive.glb", options, Path("robot.glb"));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_TRUE(summary->loops);
  const GltfFile packed = Open("robot.glb");
  const auto mesh = ReadMorphMesh(packed, 15);
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_EQ(mesh->target_names, summary->shape_names);
  EXPECT_EQ(mesh->targets.size(), 4u);
}

AnimationClip ClipOfLength(double duration) {
  AnimationClip clip;
  clip.name = "Run";
  clip.duration = duration;
  return clip;
}

TEST(ClipMoments, SpreadOverALoop_LeavesOutItsEnd) {
  EXPECT_EQ(bake::SpreadMoments(ClipOfLength(2), 4, true).value(),
            (Vector<double>{0, 0.5, 1, 1.5}));
  EXPECT_EQ(bake::SpreadMoments(ClipOfLength(2), 5, false).value(),
            (Vector<double>{0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(bake::SpreadMoments(ClipOfLength(2), 1, false).value(), (Vector<double>{0}));
}

TEST(ClipMoments, SpreadMoments_AreEvenToAHundredthOfTheirDistanceAndHaveShortNames) {
  for (const double duration : {0.0123, 0.958333, 7.0, 3600.0 / 7}) {
    for (const int count : {2, 3, 30}) {
      const AnimationClip clip = ClipOfLength(duration);
      const auto moments = bake::SpreadMoments(clip, count, true).value();
      ASSERT_EQ(moments.size(), static_cast<size_t>(count));
      for (int k = 0; k < count; ++k) {
        const double step = duration / count;
        EXPECT_NEAR(moments[static_cast<size_t>(k)], k * step, 0.01 * step);
        EXPECT_LE(bake::MomentName(clip, moments[static_cast<size_t>(k)]).size(), 11u);
      }
    }
  }
}

TEST(ClipMoments, Names_AreAsShortAsTheTime) {
  EXPECT_EQ(bake::MomentName(ClipOfLength(1), 0), "Run@0");
  EXPECT_EQ(bake::MomentName(ClipOfLength(1), 0.1), "Run@0.1");
  EXPECT_EQ(bake::MomentName(ClipOfLength(1), 0.30000000000000004), "Run@0.30000000000000004");
}

TEST(ClipMoments, ImpossibleTimes_AreRefusedWithTheLength) {
  const AnimationClip clip = ClipOfLength(0.9583);
  const double kNan = std::nan("");
  for (const Vector<double>& times :
       Vector<Vector<double>>{{}, {-0.1}, {kNan}, {HUGE_VAL}, {0.96}, {0.1, 0.2, 0.1}}) {
    EXPECT_EQ(bake::CheckMoments(clip, times).status().code(), StatusCode::kInvalidArgument);
  }
  EXPECT_NE(bake::CheckMoments(clip, Vector<double>{2}).status().message().find("0.958 s"),
            std::string::npos);
  // The length as the message shows it may be given back.
  EXPECT_TRUE(bake::CheckMoments(clip, Vector<double>{0.958}).ok());
  EXPECT_TRUE(bake::CheckMoments(ClipOfLength(0.95796), Vector<double>{0.958}).ok());
  EXPECT_FALSE(bake::SpreadMoments(ClipOfLength(0), 2, true).ok());
  EXPECT_TRUE(bake::SpreadMoments(ClipOfLength(0), 1, true).ok());
}

}  // namespace
}  // namespace limber::test
