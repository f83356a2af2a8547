// One baked file of each format version is kept for good: newer libraries read older files.
#include "import/import_gltf.h"
#include "load/rig_loader.h"
#include "rig/rig_fields.h"
#include "solve/pose_solver.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace limber {
namespace {

const std::filesystem::path kContent = std::filesystem::path(LIMBER_SOURCE_DIR) / "content";

TEST(BakedVersions, EachVersionsFile_LoadsAndDeforms) {
  for (int version = kOldestRigFormatVersion; version <= kRigFormatVersion; ++version) {
    std::string folder = "v";
    folder += std::to_string(version);
    const auto file = kContent / "baked" / folder / "square.glb";
    Result<std::shared_ptr<const Rig>> rig = LoadRig(file);
    ASSERT_TRUE(rig.ok()) << rig.status().message();
    EXPECT_EQ((*rig)->tables().handle_reach.empty(), version < 2);
    EXPECT_EQ((*rig)->tables().single_mode_transforms.empty(), version < 2);
    Result<PoseState> state = PoseState::Create(*rig);
    ASSERT_TRUE(state.ok()) << state.status().message();
    // Half way between the square and the puffed shape, as when it was baked.
    const int right = (*rig)->FindHandle("right");
    ASSERT_GE(right, 0);
    Vec3 target = state->target(right);
    target.x += 0.3f;
    ASSERT_TRUE(state->SetTarget(right, target).ok());
    PoseOptions options;
    options.iterations = 100;
    ASSERT_TRUE(state->Solve(options, nullptr).ok());
    for (int g = 0; g < (*rig)->num_groups(); ++g) {
      EXPECT_NEAR(state->blend_weights()[static_cast<size_t>(g * 3)], 0.5, 1e-3);
      EXPECT_NEAR(state->blend_weights()[static_cast<size_t>(g * 3 + 1)], 0.5, 1e-3);
    }
  }
}

// Without the base the first target is at rest; the file's normals, the base's, would be wrong.
TEST(BakedVersions, WithoutTheBase_TheFilesNormalsAreNotUsed) {
  bake::ImportOptions without_base;
  without_base.include_base = false;
  const auto source = kContent / "characters" / "dragonlet.glb";
  Result<bake::RawCharacter> raw = bake::ImportGltf(source, without_base);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  EXPECT_EQ(raw->shape_names.front(), "squash");
  EXPECT_TRUE(raw->normals.empty());
}

}  // namespace
}  // namespace limber
