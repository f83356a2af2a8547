// The Khronos validator over what Limber writes: no error, no warning (tests/validate_gltf.mjs).
#include "bake/write_baked.h"
#include "core/vector.h"
#include "editor_tools/write/synthetic_bake.h"
#include "import/import_gltf.h"
#include "import/pack_obj.h"
#include "support/gltf_validator.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace limber::test {
namespace {

namespace fs = std::filesystem;

class Validator : public testing::Test {
 protected:
  void SetUp() override {
    const ValidatorState state = FindGltfValidator(folder_.path());
    if (state == ValidatorState::kMissing) {
      GTEST_SKIP() << "no Khronos validator here: npm install --prefix tests";
    }
    ASSERT_EQ(state, ValidatorState::kReady) << "the validator must refuse a bad file";
  }

  void BakeAndValidate(const fs::path& source, const fs::path& out) {
    const auto raw = bake::ImportGltf(source);
    ASSERT_TRUE(raw.ok()) << raw.status().message();
    const Status status = bake::WriteBaked(source, *raw, MakeSyntheticBake(*raw, {}), out);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_TRUE(IsValidGltf(out)) << out;
  }

  TemporaryFolder folder_;
};

TEST_F(Validator, BakedGlbAndGltf_AreClean) {
  const fs::path source = WritePlainSource(folder_.path());
  EXPECT_TRUE(IsValidGltf(source));
  BakeAndValidate(source, folder_.path() / "out.glb");
  BakeAndValidate(source, folder_.path() / "out.gltf");
  BakeAndValidate(folder_.path() / "out.glb", folder_.path() / "again.glb");
}

TEST_F(Validator, PackedObj_IsCleanBeforeAndAfterABake) {
  const fs::path base = folder_.path() / "base.obj", shape = folder_.path() / "bent.obj";
  const std::string faces = "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3 4/1\nf 4/2 3/3 5/1\n";
  std::ofstream(base) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nv 7 7 7\n" << faces;
  std::ofstream(shape) << "v 0 0 0\nv 1 0 0.5\nv 1 1 0.5\nv 0 1 0\nv 0 2 1e-30\nv 7 7 7\n" << faces;
  const fs::path packed = folder_.path() / "packed.glb";
  const Vector<fs::path> shapes = {shape};
  const Status status = bake::PackObj(base, shapes, {}, packed);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(IsValidGltf(packed));
  BakeAndValidate(packed, folder_.path() / "baked.glb");
}

}  // namespace
}  // namespace limber::test
