// A character baked again under instances that live on.
#include "capi_fixture.h"
#include "core/vector.h"

#include <atomic>
#include <cmath>
#include <thread>

namespace limber::test {
namespace {

class CapiSwitch : public CapiTest {
 protected:
  LimberRigId Load(const char* file) {
    LimberRigId rig = {};
    const std::string path = std::string(LIMBER_SOURCE_DIR) + "/content/baked/" + file;
    EXPECT_EQ(limberLoadRig(context_, path.c_str(), nullptr, &rig), LIMBER_SUCCESS) << Message();
    return rig;
  }

  Vector<float> Skin(LimberInstanceId instance) {
    Vector<float> positions(size_t{3} * info_.num_vertices);
    LimberSkinDef skin = limberDefaultSkinDef();
    skin.num_vertices = info_.num_vertices;
    skin.positions.data = positions.data();
    EXPECT_EQ(limberSkin(context_, instance, &skin), LIMBER_SUCCESS) << Message();
    return positions;
  }

  void Solve(int32_t iterations) {
    LimberSolveDef def = limberDefaultSolveDef();
    def.iterations = iterations;
    ASSERT_EQ(limberSolve(context_, instance_, &def, nullptr), LIMBER_SUCCESS) << Message();
  }
};

TEST_F(CapiSwitch, SameCharacterLoadedAgain_KeepsThePose) {
  const float size = info_.diagonal, turn[] = {0, 0.1f, 0, 1};
  LimberHandleState handle;
  ASSERT_EQ(limberGetHandle(context_, instance_, 0, &handle), LIMBER_SUCCESS);
  const float target[] = {handle.target[0] + 0.05f * size, handle.target[1], handle.target[2]};
  ASSERT_EQ(limberSetTarget(context_, instance_, 0, target), LIMBER_SUCCESS);
  ASSERT_EQ(limberSetStiffness(context_, instance_, 0, 20), LIMBER_SUCCESS);
  ASSERT_EQ(limberUnpin(context_, instance_, 1), LIMBER_SUCCESS);
  ASSERT_EQ(limberSetTargetRotation(context_, instance_, 0, turn, 10), LIMBER_SUCCESS);
  Solve(300);
  const Vector<float> before = Skin(instance_);
  const LimberRigId again = Load("v2/tube.glb");
  ASSERT_EQ(limberSwitchRig(context_, instance_, again), LIMBER_SUCCESS) << Message();
  ASSERT_EQ(limberDestroyRig(context_, rig_), LIMBER_SUCCESS);
  LimberHandleState of;
  ASSERT_EQ(limberGetHandle(context_, instance_, 0, &of), LIMBER_SUCCESS);
  EXPECT_EQ(Vector<float>(of.target, of.target + 3), Vector<float>(target, target + 3));
  ASSERT_EQ(limberGetHandle(context_, instance_, 1, &of), LIMBER_SUCCESS);
  EXPECT_EQ(of.pinned, 0);
  const Vector<float> after = Skin(instance_);
  for (size_t i = 0; i < before.size(); ++i)
    ASSERT_NEAR(after[i], before[i], 1e-3f * size) << i;
  // What was asked for is asked for still: from a soft target to a hard one there is a way to go.
  Solve(300);
  LimberHandleState soft, hard;
  ASSERT_EQ(limberGetHandle(context_, instance_, 0, &soft), LIMBER_SUCCESS);
  ASSERT_EQ(limberSetStiffness(context_, instance_, 0, LIMBER_HELD_EXACTLY), LIMBER_SUCCESS);
  Solve(300);
  ASSERT_EQ(limberGetHandle(context_, instance_, 0, &hard), LIMBER_SUCCESS);
  EXPECT_GT(std::abs(hard.position[0] - soft.position[0]), 1e-4f * size);
  EXPECT_NEAR(hard.position[0], target[0], 1e-4f * size);
}

TEST_F(CapiSwitch, OtherCharacter_TakesWhatItHasNamesFor) {
  const LimberRigId square = Load("v3/square.glb");
  ASSERT_EQ(limberSwitchRig(context_, instance_, square), LIMBER_SUCCESS) << Message();
  ASSERT_EQ(limberGetRigInfo(context_, square, &info_), LIMBER_SUCCESS);
  Solve(1);
  for (const float x : Skin(instance_))
    EXPECT_TRUE(std::isfinite(x));
  ASSERT_EQ(limberSwitchRig(context_, instance_, rig_), LIMBER_SUCCESS) << "and back";
}

TEST_F(CapiSwitch, Misuse_LeavesTheInstance) {
  const LimberRigId none = {};
  const LimberInstanceId nobody = {};
  EXPECT_EQ(limberSwitchRig(context_, instance_, none), LIMBER_ERROR_STALE_ID);
  EXPECT_EQ(limberSwitchRig(context_, nobody, rig_), LIMBER_ERROR_STALE_ID);
  EXPECT_EQ(limberSwitchRig(nullptr, instance_, rig_), LIMBER_ERROR_INVALID_ARGUMENT);
  Solve(1);
}

// Frames go on while another thread loads; each instance switches between two of its own frames.
TEST_F(CapiSwitch, ReloadWhileFramesRun_NeverStopsThem) {
  std::atomic<uint64_t> newest = uint64_t{rig_.generation} << 32 | rig_.index;
  std::atomic<bool> ended = false;
  std::thread loader([&] {
    Vector<LimberRigId> old;
    for (int i = 0; i < 10; ++i) {
      const LimberRigId rig = Load("v2/tube.glb");
      newest = uint64_t{rig.generation} << 32 | rig.index;
    }
    ended = true;
  });
  const auto play = [&](LimberInstanceId instance) {
    uint64_t mine = 0;
    for (int frame = 0; frame < 100 || !ended; ++frame) {
      if (const uint64_t now = newest; now != mine) {
        mine = now;
        EXPECT_EQ(limberSwitchRig(context_, instance, {uint32_t(now), uint32_t(now >> 32)}),
                  LIMBER_SUCCESS);
      }
      const float target[] = {0.001f * float(frame % 50) * info_.diagonal, 0, 0};
      EXPECT_EQ(limberSetTarget(context_, instance, 0, target), LIMBER_SUCCESS);
      EXPECT_EQ(limberSolve(context_, instance, nullptr, nullptr), LIMBER_SUCCESS);
    }
  };
  LimberInstanceId other = {};
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_SUCCESS);
  std::thread player(play, other);
  play(instance_);
  player.join();
  loader.join();
}

}  // namespace
}  // namespace limber::test
