// Every misuse gets a code and one line that says what was wrong; none crashes.
#include "capi_fixture.h"
#include "core/vector.h"

#include <array>
#include <cstring>
#include <functional>
#include <limits>

namespace limber::test {
namespace {

struct Misuse {
  const char* what;
  LimberResult expected;
  const char* says;  // part of the message
  std::function<LimberResult()> call;
};

class CapiMisuse : public CapiTest {
 protected:
  void ExpectRefused(const Vector<Misuse>& all) {
    for (const Misuse& misuse : all) {
      log_.clear();
      EXPECT_EQ(misuse.call(), misuse.expected) << misuse.what << ": " << Message();
      EXPECT_NE(Message().find(misuse.says), std::string::npos) << misuse.what << ": " << Message();
      EXPECT_EQ(Message().rfind("limber", 0), 0u) << "the function comes first: " << Message();
      EXPECT_EQ(Message().find('\n'), std::string::npos);
      ASSERT_EQ(log_.size(), 1u) << misuse.what;
      EXPECT_EQ(log_[0], Message());
    }
    EXPECT_EQ(limberSolve(context_, instance_, nullptr, nullptr), LIMBER_SUCCESS)
        << "the instance is as it was";
  }

  const float at_[3] = {0, 0, 0};
  int32_t handle_ = 0;
  LimberRigId out_rig_ = {};
  LimberInstanceId out_instance_ = {};
};

TEST_F(CapiMisuse, Nulls) {
  ExpectRefused({
      {"path", LIMBER_ERROR_INVALID_ARGUMENT, "path: is null",
       [&] { return limberLoadRig(context_, nullptr, nullptr, &out_rig_); }},
      {"rig", LIMBER_ERROR_INVALID_ARGUMENT, "rig: is null",
       [&] { return limberLoadRig(context_, "x", nullptr, nullptr); }},
      {"bytes", LIMBER_ERROR_INVALID_ARGUMENT, "bytes: is null",
       [&] { return limberLoadRigFromMemory(context_, nullptr, 9, "x", nullptr, &out_rig_); }},
      {"info", LIMBER_ERROR_INVALID_ARGUMENT, "info: is null",
       [&] { return limberGetRigInfo(context_, rig_, nullptr); }},
      {"handle info", LIMBER_ERROR_INVALID_ARGUMENT, "info: is null",
       [&] { return limberGetHandleInfo(context_, rig_, 0, nullptr); }},
      {"name", LIMBER_ERROR_INVALID_ARGUMENT, "name: is null",
       [&] { return limberFindHandle(context_, rig_, nullptr, &handle_); }},
      {"handle", LIMBER_ERROR_INVALID_ARGUMENT, "handle: is null",
       [&] { return limberFindHandle(context_, rig_, "x", nullptr); }},
      {"instance", LIMBER_ERROR_INVALID_ARGUMENT, "instance: is null",
       [&] { return limberCreateInstance(context_, rig_, nullptr, nullptr); }},
      {"position", LIMBER_ERROR_INVALID_ARGUMENT, "position: is null",
       [&] { return limberSetTarget(context_, instance_, 0, nullptr); }},
      {"rotation", LIMBER_ERROR_INVALID_ARGUMENT, "rotation: is null",
       [&] {
         return limberSetTargetRotation(context_, instance_, 0, nullptr, LIMBER_HELD_EXACTLY);
       }},
      {"weights", LIMBER_ERROR_INVALID_ARGUMENT, "weights: is null",
       [&] { return limberGetBlendWeights(context_, instance_, nullptr, 1); }},
      {"skin def", LIMBER_ERROR_INVALID_ARGUMENT, "def: is null",
       [&] { return limberSkin(context_, instance_, nullptr); }},
  });
}

TEST_F(CapiMisuse, NullContext_IsAnsweredWithoutOne) {
  EXPECT_EQ(limberSolve(nullptr, instance_, nullptr, nullptr), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(limberLoadRig(nullptr, "x", nullptr, &out_rig_), LIMBER_ERROR_INVALID_ARGUMENT);
  limberDestroyContext(nullptr);
}

TEST_F(CapiMisuse, StaleAndInventedIds) {
  LimberInstanceId gone;
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &gone), LIMBER_SUCCESS);
  ASSERT_EQ(limberDestroyInstance(context_, gone), LIMBER_SUCCESS);
  LimberInstanceId next;  // in the same slot
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &next), LIMBER_SUCCESS);
  EXPECT_EQ(next.index, gone.index);
  const Vector<LimberInstanceId> none = {
      gone, {0, 0}, {12345, 1}, {UINT32_MAX, UINT32_MAX}, {instance_.index, 77}};
  Vector<Misuse> all;
  for (const LimberInstanceId id : none) {
    all.push_back({"solve", LIMBER_ERROR_STALE_ID, "is gone, or never was",
                   [=, this] { return limberSolve(context_, id, nullptr, nullptr); }});
    all.push_back({"destroy", LIMBER_ERROR_STALE_ID, "instance",
                   [=, this] { return limberDestroyInstance(context_, id); }});
    all.push_back({"target", LIMBER_ERROR_STALE_ID, "instance",
                   [=, this] { return limberSetTarget(context_, id, 0, at_); }});
  }
  all.push_back({"rig", LIMBER_ERROR_STALE_ID, "rig 3.9", [this] {
                   return limberDestroyRig(context_, LimberRigId{3, 9});
                 }});
  ExpectRefused(all);
}

TEST_F(CapiMisuse, WrongNumbers) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float not_finite[] = {0, nan, 0}, no_turn[] = {0, 0, 0, 0};
  std::array<double, 3> weights;
  LimberSolveDef negative = limberDefaultSolveDef(), backwards = limberDefaultSolveDef();
  negative.iterations = -1;
  backwards.smoothing = 0.1;
  backwards.time_step = -1;
  LimberInstanceDef huge = limberDefaultInstanceDef();
  huge.max_rotations = 1 << 30;
  LimberRigDef second = limberDefaultRigDef();
  second.rig_index = 5;
  ExpectRefused({
      {"handle too large", LIMBER_ERROR_INVALID_ARGUMENT, "handle",
       [&] { return limberSetTarget(context_, instance_, 1000, at_); }},
      {"handle negative", LIMBER_ERROR_INVALID_ARGUMENT, "handle",
       [&] { return limberSetTarget(context_, instance_, -1, at_); }},
      {"handle info", LIMBER_ERROR_INVALID_ARGUMENT, "handle 99",
       [&] {
         LimberHandleInfo info;
         return limberGetHandleInfo(context_, rig_, 99, &info);
       }},
      {"unknown name", LIMBER_ERROR_NOT_FOUND, "there are",
       [&] { return limberFindHandle(context_, rig_, "nose", &handle_); }},
      {"not finite", LIMBER_ERROR_INVALID_ARGUMENT, "limberSetTarget",
       [&] { return limberSetTarget(context_, instance_, 0, not_finite); }},
      {"no rotation", LIMBER_ERROR_INVALID_ARGUMENT, "limberSetTargetRotation",
       [&] {
         return limberSetTargetRotation(context_, instance_, 0, no_turn, LIMBER_HELD_EXACTLY);
       }},
      {"count", LIMBER_ERROR_INVALID_ARGUMENT, "count: 3",
       [&] { return limberGetBlendWeights(context_, instance_, weights.data(), 3); }},
      {"iterations", LIMBER_ERROR_INVALID_ARGUMENT, "limberSolve",
       [&] { return limberSolve(context_, instance_, &negative, nullptr); }},
      {"time step", LIMBER_ERROR_INVALID_ARGUMENT, "limberSolve",
       [&] { return limberSolve(context_, instance_, &backwards, nullptr); }},
      {"room", LIMBER_ERROR_INVALID_ARGUMENT, "limberCreateInstance",
       [&] { return limberCreateInstance(context_, rig_, &huge, &out_instance_); }},
      {"no such rig in the file", LIMBER_ERROR_INVALID_ARGUMENT, "tube.glb",
       [&] { return limberLoadRig(context_, BakedTube().c_str(), &second, &out_rig_); }},
  });
}

TEST_F(CapiMisuse, SkinOutputs) {
  Vector<float> room(16 * size_t{info_.num_vertices});
  const auto with = [&](size_t stride, uint32_t count) {
    LimberSkinDef def = limberDefaultSkinDef();
    def.num_vertices = count;
    def.positions = {room.data(), stride};
    return limberSkin(context_, instance_, &def);
  };
  LimberInstanceDef def = limberDefaultInstanceDef();
  def.skin = 0;
  ASSERT_EQ(limberCreateInstance(context_, rig_, &def, &out_instance_), LIMBER_SUCCESS);
  LimberSkinDef skin = limberDefaultSkinDef();
  ExpectRefused({
      {"too near", LIMBER_ERROR_INVALID_ARGUMENT, "positions: a stride of 8",
       [&] { return with(8, info_.num_vertices); }},
      {"crooked", LIMBER_ERROR_INVALID_ARGUMENT, "multiple of 4",
       [&] { return with(14, info_.num_vertices); }},
      {"too few", LIMBER_ERROR_INVALID_ARGUMENT, "num_vertices",
       [&] { return with(12, info_.num_vertices - 1); }},
      {"without room", LIMBER_ERROR_UNSUPPORTED, "LimberInstanceDef::skin",
       [&] { return limberSkin(context_, out_instance_, &skin); }},
  });
}

TEST_F(CapiMisuse, DefsThatAreNotDefault) {
  LimberSolveDef zero;
  std::memset(&zero, 0, sizeof zero);
  LimberSolveDef newer = limberDefaultSolveDef();
  newer.struct_size = sizeof(newer) + 8;
  LimberSolveDef tiny = limberDefaultSolveDef();
  tiny.struct_size = 3;
  LimberInstanceDef other;
  const LimberRigDef of_rig = limberDefaultRigDef();
  std::memset(&other, 0, sizeof other);
  std::memcpy(&other, &of_rig, sizeof of_rig);
  ExpectRefused({
      {"zeros", LIMBER_ERROR_STRUCT_NOT_DEFAULT, "limberDefaultSolveDef()",
       [&] { return limberSolve(context_, instance_, &zero, nullptr); }},
      {"newer", LIMBER_ERROR_VERSION_MISMATCH, "newer limber.h",
       [&] { return limberSolve(context_, instance_, &newer, nullptr); }},
      {"tiny", LIMBER_ERROR_VERSION_MISMATCH, "3 bytes",
       [&] { return limberSolve(context_, instance_, &tiny, nullptr); }},
      {"another's", LIMBER_ERROR_STRUCT_NOT_DEFAULT, "limberDefaultInstanceDef()",
       [&] { return limberCreateInstance(context_, rig_, &other, &out_instance_); }},
  });
}

// A caller with an older header has a shorter struct; what it had not is the default.
TEST_F(CapiTest, OlderDefs_AreCompleted) {
  LimberSolveDef older = limberDefaultSolveDef();
  older.iterations = 2;
  older.struct_size = offsetof(LimberSolveDef, nearness);
  older.nearness = -5;  // beyond the older struct's end
  LimberSolveReport report;
  ASSERT_EQ(limberSolve(context_, instance_, &older, &report), LIMBER_SUCCESS) << Message();
  EXPECT_EQ(report.iterations, 2);
}

TEST(CapiContext, HeaderOfAnotherMajorVersion_IsRefused) {
  LimberContext* context = nullptr;
  LimberContextDef def = limberDefaultContextDef();
  def.header_version = LIMBER_MAKE_VERSION(LIMBER_VERSION_MAJOR + 1, 0, 0);
  EXPECT_EQ(limberCreateContext(&def, &context), LIMBER_ERROR_VERSION_MISMATCH);
  char message[200];
  EXPECT_GT(limberGetLastMessage(nullptr, message, sizeof message), 10u);
  EXPECT_NE(std::string(message).find("major version"), std::string::npos);
  EXPECT_EQ(context, nullptr);
  EXPECT_EQ(limberCreateContext(nullptr, nullptr), LIMBER_ERROR_INVALID_ARGUMENT);
  LimberContextDef zero;
  std::memset(&zero, 0, sizeof zero);
  EXPECT_EQ(limberCreateContext(&zero, &context), LIMBER_ERROR_STRUCT_NOT_DEFAULT);
}

TEST_F(CapiTest, BadFiles_AreRefusedWithTheFile) {
  LimberRigId rig;
  EXPECT_EQ(limberLoadRig(context_, "/nowhere/x.glb", nullptr, &rig), LIMBER_ERROR_NOT_FOUND);
  EXPECT_NE(Message().find("/nowhere/x.glb"), std::string::npos);
  Vector<char> bytes = ReadBytes(BakedTube());
  bytes.resize(bytes.size() / 2);
  EXPECT_EQ(limberLoadRigFromMemory(context_, bytes.data(), bytes.size(), "half", nullptr, &rig),
            LIMBER_ERROR_MALFORMED);
  EXPECT_NE(Message().find("half"), std::string::npos) << Message();
}

TEST_F(CapiTest, Message_IsCutToTheRoom) {
  LimberRigId rig;
  ASSERT_NE(limberLoadRig(context_, nullptr, nullptr, &rig), LIMBER_SUCCESS);
  char message[7];
  std::memset(message, 'x', sizeof message);
  EXPECT_EQ(limberGetLastMessage(context_, message, 6), Message().size());
  EXPECT_STREQ(message, "limbe");
  EXPECT_EQ(message[6], 'x');
}

TEST(CapiResults, HaveNames) {
  for (LimberResult result = 0; result <= LIMBER_ERROR_INTERNAL; ++result)
    EXPECT_STRNE(limberResultString(result), "unknown") << result;
  EXPECT_STREQ(limberResultString(99), "unknown");
  EXPECT_EQ(limberGetVersion(), uint32_t{LIMBER_VERSION});
}

}  // namespace
}  // namespace limber::test
