// Real files: Khronos samples and characters import with the counts that are known of them.
#include "core/vector.h"
#include "import/import_gltf.h"
#include "import/pack_obj.h"
#include "import/source_faces.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace limber::test {
namespace {

namespace fs = std::filesystem;

struct Sample {
  const char* path;
  const char* node;
  int vertices, triangles;
  size_t shapes, primitives;
};

class Samples : public testing::TestWithParam<Sample> {};

TEST_P(Samples, Import_HasTheKnownCounts) {
  const fs::path data = SharedDataFolder();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  const Sample& sample = GetParam();
  bake::ImportOptions options;
  options.node = sample.node;
  const auto raw = bake::ImportGltf(data / sample.path, options);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  EXPECT_EQ(raw->num_draw_vertices(), sample.vertices);
  EXPECT_EQ(raw->triangles.size() / 3, static_cast<size_t>(sample.triangles));
  EXPECT_EQ(raw->shapes.size(), sample.shapes);
  EXPECT_EQ(raw->primitives.size(), sample.primitives);
  EXPECT_TRUE(raw->warnings.empty());
  for (const bake::PointMatrix& shape : raw->shapes)
    EXPECT_TRUE(shape.allFinite());
}

INSTANTIATE_TEST_SUITE_P(
    Data, Samples,
    testing::Values(
        Sample{"gltf_samples/AnimatedMorphCube/glTF/AnimatedMorphCube.gltf", "", 24, 12, 3, 1},
        Sample{"gltf_samples/AnimatedMorphSphere/glTF/AnimatedMorphSphere.gltf", "", 1876, 960, 3,
               1},
        Sample{"gltf_samples/SimpleMorph/glTF/SimpleMorph.gltf", "", 3, 1, 3, 1},
        Sample{"gltf_samples/MorphStressTest/glTF/MorphStressTest.gltf", "", 1528, 2412, 9, 2},
        Sample{"gltf_samples/MorphPrimitivesTest/glTF/MorphPrimitivesTest.gltf", "", 30, 32, 2, 2},
        Sample{"characters/lion-poses.glb", "", 5000, 9996, 10, 1},
        Sample{"characters/head-poses.glb", "", 15941, 31620, 10, 1},
        Sample{"characters/makehuman_poses.glb", "", 13380, 26756, 13, 1},
        Sample{"characters/ict_facekit_expressions.glb", "", 26719, 52220, 58, 1}));

TEST(Samples, SeveralMeshesWithTargets_AreListedAndOneCanBeChosen) {
  const fs::path data = SharedDataFolder();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  const fs::path robot = data / "gltf_samples/RobotExpressive.glb";
  const Status status = bake::ImportGltf(robot).status();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("\"Head_4\" (8)"), std::string::npos) << status.message();
  bake::ImportOptions options;
  options.node = "Head_4";
  const auto raw = bake::ImportGltf(robot, options);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  EXPECT_EQ(raw->shapes.size(), 4u);
  EXPECT_EQ(raw->shape_names[1], "Angry");
}

TEST(Samples, Horse_PacksAndComesBackInItsOwnOrder) {
  const fs::path data = SharedDataFolder();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  const TemporaryFolder folder;
  const fs::path base = data / "horse/horse_ref.obj", out = folder.path() / "horse.glb";
  Vector<fs::path> shapes;
  for (const char* pose : {"01", "02", "03", "05"}) {
    shapes.push_back(data / ("horse/horse-" + std::string(pose) + ".obj"));
  }
  const Status status = bake::PackObj(base, shapes, {}, out);
  ASSERT_TRUE(status.ok()) << status.message();
  const auto raw = bake::ImportGltf(out);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  EXPECT_EQ(raw->num_source_vertices, 8431u);
  EXPECT_EQ(raw->triangles.size() / 3, 16843u);
  EXPECT_EQ(raw->shapes.size(), 5u);
  const auto file = GltfFile::Open(out);
  const auto source = bake::ReadObj(base);
  ASSERT_TRUE(file.ok() && source.ok());
  const auto faces = bake::ReadSourceFaces(*file, 0);
  ASSERT_TRUE(faces.ok());
  EXPECT_EQ(faces->sizes, source->face_sizes);
  ASSERT_EQ(faces->corners.size(), source->corners.size());
  for (size_t c = 0; c < source->corners.size(); ++c) {
    ASSERT_EQ(faces->corners[c], source->corners[c].position) << c;
  }
}

}  // namespace
}  // namespace limber::test
