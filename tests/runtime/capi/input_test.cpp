// limber.h: springs, clips and recordings.
#include "capi_fixture.h"
#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"
#include "load/glb_container.h"
#include "support/counting_allocator.h"
#include "support/temporary_folder.h"

#include <cmath>
#include <cstring>

namespace limber::test {
namespace {

class CapiInput : public CapiTest {
 protected:
  int32_t Handle(const char* name) {
    int32_t handle = -1;
    EXPECT_EQ(limberFindHandle(context_, rig_, name, &handle), LIMBER_SUCCESS) << Message();
    return handle;
  }

  LimberHandleState State(LimberInstanceId instance, int32_t handle) {
    LimberHandleState state = {};
    EXPECT_EQ(limberGetHandle(context_, instance, handle, &state), LIMBER_SUCCESS);
    return state;
  }

  // The tube with a clip of one second: "right" goes up by 0.3 and turns about z by 0.4.
  LimberRigId LoadWithClip() {
    const Vector<char> file = ReadBytes(BakedTube());
    const auto* first = reinterpret_cast<const uint8_t*>(file.data());
    const Result<GlbChunks> chunks = SplitGlb({first, file.size()});
    EXPECT_TRUE(chunks.ok());
    GltfParts parts;
    parts.json = nlohmann::ordered_json::parse(chunks->json);
    parts.bin.assign(chunks->bin.begin(), chunks->bin.end());
    parts.json["animations"] = {{{"name", "Lift"},
                                 {"channels", nlohmann::ordered_json::array()},
                                 {"samplers", nlohmann::ordered_json::array()}}};
    AddChannel(&parts, 0, 3, "translation", {0, 1}, {1.05f, 0, 0, 1.05f, 0.3f, 0});
    AddChannel(&parts, 0, 3, "rotation", {0, 1},
               {0, 0, 0, 1, 0, 0, std::sin(0.2f), std::cos(0.2f)});
    const Vector<uint8_t> glb = parts.Glb();
    LimberRigId rig = {};
    EXPECT_EQ(limberLoadRigFromMemory(context_, glb.data(), glb.size(), "clip", nullptr, &rig),
              LIMBER_SUCCESS)
        << Message();
    return rig;
  }
};

TEST_F(CapiInput, Follow_ReachesTheGoalAtAnyFrameRate) {
  const int32_t right = Handle("right");
  const LimberHandleState rest = State(instance_, right);
  const float goal[3] = {rest.target[0] - 0.1f, rest.target[1] + 0.2f, rest.target[2]};
  Vector<float> after_a_third;
  for (const int frames : {20, 40, 100}) {
    LimberInstanceId one;
    ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &one), LIMBER_SUCCESS);
    LimberFollowDef def = limberDefaultFollowDef();
    // The jump itself takes no time; from then on the goal stays.
    def.time_step = 1e-9;
    ASSERT_EQ(limberFollow(context_, one, right, goal, &def), LIMBER_SUCCESS) << Message();
    def.time_step = 1.0 / 3 / frames;
    for (int i = 0; i < frames; ++i)
      ASSERT_EQ(limberFollow(context_, one, right, goal, &def), LIMBER_SUCCESS);
    after_a_third.push_back(State(one, right).target[1]);
    for (int i = 0; i < 10 * frames; ++i)
      ASSERT_EQ(limberFollow(context_, one, right, goal, &def), LIMBER_SUCCESS);
    EXPECT_NEAR(State(one, right).target[1], goal[1], 1e-5);
  }
  EXPECT_NEAR(after_a_third[1], after_a_third[0], 1e-6);
  EXPECT_NEAR(after_a_third[2], after_a_third[0], 1e-6);
  EXPECT_GT(std::abs(after_a_third[0] - goal[1]), 1e-3) << "it should still be on its way";
}

TEST_F(CapiInput, Follow_StaysWithinReachAndGoesOnFromOtherTargets) {
  const int32_t right = Handle("right"), left = Handle("left");
  LimberFollowDef def = limberDefaultFollowDef();
  def.time_step = 1.0 / 60;
  def.damping = 0.1;  // swings
  const float far[3] = {100, 30, 0};
  for (int i = 0; i < 600; ++i) {
    ASSERT_EQ(limberFollow(context_, instance_, right, far, &def), LIMBER_SUCCESS) << Message();
    const LimberHandleState a = State(instance_, right), b = State(instance_, left);
    const float apart =
        std::hypot(a.target[0] - b.target[0], a.target[1] - b.target[1], a.target[2] - b.target[2]);
    ASSERT_LT(apart, 2 * info_.diagonal) << i;
  }
  const float elsewhere[3] = {0.9f, 0, 0};
  ASSERT_EQ(limberSetTarget(context_, instance_, right, elsewhere), LIMBER_SUCCESS);
  ASSERT_EQ(limberFollow(context_, instance_, right, elsewhere, &def), LIMBER_SUCCESS);
  EXPECT_EQ(State(instance_, right).target[0], 0.9f) << "no speed is left of before";
}

TEST_F(CapiInput, Clip_MovesAndTurnsItsHandles) {
  const LimberRigId rig = LoadWithClip();
  int32_t count = 0, clip = -1;
  ASSERT_EQ(limberGetNumClips(context_, rig, &count), LIMBER_SUCCESS);
  ASSERT_EQ(count, 1);
  ASSERT_EQ(limberFindClip(context_, rig, "Lift", &clip), LIMBER_SUCCESS);
  LimberClipInfo info = {};
  ASSERT_EQ(limberGetClipInfo(context_, rig, clip, &info), LIMBER_SUCCESS);
  EXPECT_STREQ(info.name, "Lift");
  EXPECT_EQ(info.duration, 1);
  EXPECT_EQ(info.num_handles, 1);
  LimberInstanceId character;
  ASSERT_EQ(limberCreateInstance(context_, rig, nullptr, &character), LIMBER_SUCCESS);
  const int32_t right = Handle("right");
  LimberClipDef def = limberDefaultClipDef();
  def.clip = clip;
  def.time = 3.5;  // goes round
  ASSERT_EQ(limberApplyClip(context_, character, &def), LIMBER_SUCCESS) << Message();
  EXPECT_NEAR(State(character, right).target[1], 0.15, 1e-6);
  def.loops = 0;
  ASSERT_EQ(limberApplyClip(context_, character, &def), LIMBER_SUCCESS);
  EXPECT_NEAR(State(character, right).target[1], 0.3, 1e-6);
  // Half of the way to another moment.
  def.time = 0;
  def.weight = 0.5f;
  ASSERT_EQ(limberApplyClip(context_, character, &def), LIMBER_SUCCESS);
  EXPECT_NEAR(State(character, right).target[1], 0.15, 1e-6);
  // A handle that is let go is left alone.
  ASSERT_EQ(limberUnpin(context_, character, right), LIMBER_SUCCESS);
  ASSERT_EQ(limberApplyClip(context_, character, &def), LIMBER_SUCCESS) << Message();
  // The rotation is asked for as well: without it the pose is another.
  Vector<Vector<double>> blends;
  for (const int32_t rotations : {0, 1}) {
    LimberInstanceId one;
    ASSERT_EQ(limberCreateInstance(context_, rig, nullptr, &one), LIMBER_SUCCESS);
    LimberClipDef turned = limberDefaultClipDef();
    turned.time = 0.9;
    turned.rotations = rotations;
    ASSERT_EQ(limberApplyClip(context_, one, &turned), LIMBER_SUCCESS);
    LimberSolveDef solve = limberDefaultSolveDef();
    solve.iterations = 20;
    ASSERT_EQ(limberSolve(context_, one, &solve, nullptr), LIMBER_SUCCESS);
    Vector<double> weights(static_cast<size_t>(info_.num_groups * info_.num_shapes));
    ASSERT_EQ(limberGetBlendWeights(context_, one, weights.data(), weights.size()), LIMBER_SUCCESS);
    blends.push_back(weights);
  }
  EXPECT_NE(blends[0], blends[1]);
}

TEST_F(CapiInput, SteadyFrames_AllocateNothing) {
  const LimberRigId rig = LoadWithClip();
  LimberInstanceId character;
  ASSERT_EQ(limberCreateInstance(context_, rig, nullptr, &character), LIMBER_SUCCESS);
  const int32_t left = Handle("left");
  LimberClipDef clip = limberDefaultClipDef();
  LimberFollowDef follow = limberDefaultFollowDef();
  follow.time_step = 1.0 / 60;
  const auto frame = [&](int i) {
    clip.time = i / 60.0;
    const float goal[3] = {-1.0f, 0.01f * static_cast<float>(i % 20), 0};
    return limberApplyClip(context_, character, &clip) == LIMBER_SUCCESS &&
           limberFollow(context_, character, left, goal, &follow) == LIMBER_SUCCESS &&
           limberSolve(context_, character, nullptr, nullptr) == LIMBER_SUCCESS;
  };
  for (int i = 0; i < 5; ++i)
    ASSERT_TRUE(frame(i)) << Message();
  const int64_t before = AllocationCount();
  bool all = true;
  for (int i = 5; i < 100; ++i)
    all &= frame(i);
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_TRUE(all);
}

TEST_F(CapiInput, Recording_IsReplayedWithTheSameBits) {
  LimberInstanceDef def = limberDefaultInstanceDef();
  def.record = 1;
  LimberInstanceId recorded;
  ASSERT_EQ(limberCreateInstance(context_, rig_, &def, &recorded), LIMBER_SUCCESS) << Message();
  const int32_t right = Handle("right");
  LimberFollowDef follow = limberDefaultFollowDef();
  follow.time_step = 1.0 / 60;
  Vector<Vector<double>> blends;
  const auto count = static_cast<size_t>(info_.num_groups * info_.num_shapes);
  const auto blend_of = [&](LimberInstanceId instance) {
    Vector<double> weights(count);
    EXPECT_EQ(limberGetBlendWeights(context_, instance, weights.data(), count), LIMBER_SUCCESS);
    return weights;
  };
  int32_t grab = -1;
  for (int frame = 0; frame < 30; ++frame) {
    const float goal[3] = {0.6f, frame > 10 ? 0.5f : 0.1f, 0};
    ASSERT_EQ(limberFollow(context_, recorded, right, goal, &follow), LIMBER_SUCCESS);
    if (frame == 8) {
      const LimberSkinPoint point = {{10, 11, 12}, {0.5f, 0.25f, 0.25f}};
      ASSERT_EQ(limberGrab(context_, recorded, &point, 20, &grab), LIMBER_SUCCESS) << Message();
      const float at[3] = {0, 0.3f, 0};
      ASSERT_EQ(limberSetGrabTarget(context_, recorded, grab, at), LIMBER_SUCCESS);
    }
    if (frame == 20) {
      ASSERT_EQ(limberRelease(context_, recorded, grab), LIMBER_SUCCESS);
    }
    ASSERT_EQ(limberSolveMany(context_, &recorded, 1, nullptr, nullptr, nullptr), LIMBER_SUCCESS);
    blends.push_back(blend_of(recorded));
  }
  size_t size = 0;
  ASSERT_EQ(limberGetRecording(context_, recorded, nullptr, 0, &size), LIMBER_SUCCESS);
  Vector<unsigned char> bytes(size);
  ASSERT_EQ(limberGetRecording(context_, recorded, bytes.data(), size, &size), LIMBER_SUCCESS);

  struct Seen {
    CapiInput* test;
    Vector<Vector<double>> blends;
  } seen{this, {}};

  static const auto* blend = &blend_of;
  blend = &blend_of;
  LimberReplayReport report = {};
  LimberReplayDef replay = limberDefaultReplayDef();
  replay.bytes = bytes.data();
  replay.num_bytes = size;
  replay.user = &seen;
  replay.on_frame = [](void* user, LimberInstanceId instance, uint32_t) {
    static_cast<Seen*>(user)->blends.push_back((*blend)(instance));
    return 0;
  };
  ASSERT_EQ(limberReplay(context_, rig_, &replay, &report), LIMBER_SUCCESS) << Message();
  EXPECT_EQ(report.num_frames, 30u);
  EXPECT_EQ(report.num_different, 0u);
  EXPECT_EQ(seen.blends, blends);
  // A rig of another bake ends it.
  LimberRigId other;
  ASSERT_EQ(limberLoadRig(context_, BakedTube().c_str(), nullptr, &other), LIMBER_SUCCESS);
  ASSERT_EQ(limberSwitchRig(context_, recorded, other), LIMBER_SUCCESS);
  EXPECT_EQ(limberGetRecording(context_, recorded, nullptr, 0, &size), LIMBER_ERROR_UNSUPPORTED);
}

TEST_F(CapiInput, Misuse_IsRefusedByName) {
  const float at[3] = {0, 0, 0};
  const auto expect = [&](LimberResult expected, const char* says, LimberResult result) {
    EXPECT_EQ(result, expected) << says << ": " << Message();
    EXPECT_NE(Message().find(says), std::string::npos) << says << ": " << Message();
  };
  LimberFollowDef follow = limberDefaultFollowDef();
  const float infinite[3] = {0, HUGE_VALF, 0};
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "def: is null",
         limberFollow(context_, instance_, 0, at, nullptr));
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "goal: is null",
         limberFollow(context_, instance_, 0, nullptr, &follow));
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "goal: it is not finite",
         limberFollow(context_, instance_, 0, infinite, &follow));
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "handle 77",
         limberFollow(context_, instance_, 77, at, &follow));
  follow.frequency = 0;
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "frequency: 0",
         limberFollow(context_, instance_, 0, at, &follow));
  follow = limberDefaultFollowDef();
  follow.time_step = -1;
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "time_step: -1",
         limberFollow(context_, instance_, 0, at, &follow));
  follow.cookie = 0;
  expect(LIMBER_ERROR_STRUCT_NOT_DEFAULT, "limberDefaultFollowDef()",
         limberFollow(context_, instance_, 0, at, &follow));
  ASSERT_EQ(limberUnpin(context_, instance_, 0), LIMBER_SUCCESS);
  follow = limberDefaultFollowDef();
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "pinned",
         limberFollow(context_, instance_, 0, at, &follow));
  LimberClipDef clip = limberDefaultClipDef();
  int32_t number = 0;
  LimberClipInfo info;
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "clip 0: there are 0",
         limberApplyClip(context_, instance_, &clip));
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "clip 3", limberGetClipInfo(context_, rig_, 3, &info));
  expect(LIMBER_ERROR_NOT_FOUND, "no clip 'Run'", limberFindClip(context_, rig_, "Run", &number));
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "count: is null",
         limberGetNumClips(context_, rig_, nullptr));
  size_t size = 0;
  expect(LIMBER_ERROR_UNSUPPORTED, "nothing is recorded",
         limberGetRecording(context_, instance_, nullptr, 0, &size));
  LimberReplayDef replay = limberDefaultReplayDef();
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "def: is null",
         limberReplay(context_, rig_, nullptr, nullptr));
  expect(LIMBER_ERROR_INVALID_ARGUMENT, "bytes: is null",
         limberReplay(context_, rig_, &replay, nullptr));
  replay.bytes = "nothing at all";
  replay.num_bytes = 14;
  expect(LIMBER_ERROR_MALFORMED, "byte 0", limberReplay(context_, rig_, &replay, nullptr));
  expect(LIMBER_ERROR_STALE_ID, "rig", limberReplay(context_, {7, 7}, &replay, nullptr));
}

}  // namespace
}  // namespace limber::test
