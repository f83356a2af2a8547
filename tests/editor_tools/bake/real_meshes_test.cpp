// Real characters with real defects bake soundly: 56 components, non-manifold vertices, degenerate
// faces, several primitives.
#include "bake/resolve_handles.h"
#include "editor_tools/bake/sound_bake.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "import/import_gltf.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <string>

namespace limber::bake {
namespace {

struct RealMesh {
  const char* file;    // below the shared data folder
  const char* node;    // empty: the only one
  size_t most_shapes;  // the first of them, to keep the test short
  int num_handles;
};

class RealMeshes : public testing::TestWithParam<RealMesh> {};

TEST_P(RealMeshes, BakeSoundly) {
  const RealMesh& mesh = GetParam();
  const std::filesystem::path folder = test::SharedDataFolder();
  if (folder.empty()) GTEST_SKIP() << "no shared data folder";
  const std::filesystem::path file = folder / mesh.file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
  ImportOptions options;
  options.node = mesh.node;
  Result<RawCharacter> raw = ImportGltf(file, options);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  if (raw->shapes.size() > mesh.most_shapes) {
    raw->shapes.resize(mesh.most_shapes);
    raw->shape_names.resize(mesh.most_shapes);
  }
  const auto& rest = raw->shapes[0];
  const double diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
  geometry::SolveMesh welded = geometry::WeldMesh(raw->shapes, raw->triangles, 1e-6 * diagonal);
  geometry::ConnectComponents(&welded);
  test::ExpectSoundBake(*raw, ChooseHandles(*raw, welded, mesh.num_handles));
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealMeshes,
    testing::Values(
        RealMesh{"characters/ict_facekit_expressions.glb", "", 4, 4},
        RealMesh{"characters/head-poses.glb", "", 3, 4},
        RealMesh{"characters/lion-poses.glb", "", 4, 5},
        RealMesh{"gltf_samples/RobotExpressive.glb", "Head_2", 9, 4},
        RealMesh{"gltf_samples/RobotExpressive.glb", "Head_3", 9, 4},
        RealMesh{"gltf_samples/RobotExpressive.glb", "Head_4", 9, 4},
        RealMesh{"gltf_samples/MorphPrimitivesTest/glTF/MorphPrimitivesTest.gltf", "", 9, 4},
        RealMesh{"gltf_samples/MorphStressTest/glTF/MorphStressTest.gltf", "", 9, 4},
        RealMesh{"gltf_samples/AnimatedMorphCube/glTF/AnimatedMorphCube.gltf", "", 9, 4},
        RealMesh{"gltf_samples/AnimatedMorphSphere/glTF/AnimatedMorphSphere.gltf", "", 9, 4}),
    [](const auto& tested) {
      std::string name =
          std::filesystem::path(tested.param.file).stem().string() + tested.param.node;
      for (char& c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
      }
      return name;
    });

}  // namespace
}  // namespace limber::bake
