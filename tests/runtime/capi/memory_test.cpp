// limber.h: all that stays comes from the host's allocator, and goes back to it.
#include "capi_fixture.h"
#include "core/vector.h"
#include "editor_tools/animation/animated_bar.h"
#include "host_heap.h"
#include "load/glb_container.h"
#include "support/counting_allocator.h"

#include <thread>

namespace limber::test {
namespace {

// The tube with names too long for the room that strings have in themselves, and with a clip.
const std::vector<uint8_t>& CharacterFile() {
  static const std::vector<uint8_t> file = [] {
    const Vector<char> tube = ReadBytes(BakedTube());
    const Result<GlbChunks> chunks =
        SplitGlb({reinterpret_cast<const uint8_t*>(tube.data()), tube.size()});
    std::string json(chunks->json);
    for (const char* name : {"\"left\"", "\"right\""}) {
      const std::string longer =
          std::string(name, std::strlen(name) - 1) + "_of_a_very_long_tube\"";
      for (size_t at = json.find(name); at != std::string::npos; at = json.find(name, at + 1))
        json.replace(at, std::strlen(name), longer);
    }
    GltfParts parts;
    parts.json = nlohmann::ordered_json::parse(json);
    parts.bin.assign(chunks->bin.begin(), chunks->bin.end());
    parts.json["animations"] = {{{"name", "A clip whose name is long as well"},
                                 {"channels", nlohmann::ordered_json::array()},
                                 {"samplers", nlohmann::ordered_json::array()}}};
    AddChannel(&parts, 0, 3, "translation", {0, 1}, {1.05f, 0, 0, 1.05f, 0.3f, 0});
    const Vector<uint8_t> glb = parts.Glb();
    return std::vector<uint8_t>(glb.begin(), glb.end());
  }();
  return file;
}

LimberResult Load(LimberContext* context, LimberRigId* rig) {
  return limberLoadRigFromMemory(context, CharacterFile().data(), CharacterFile().size(),
                                 "a character of a very long name", nullptr, rig);
}

// Goes on unless it failed already.
#define LIMBER_TRY(call)                                         \
  do {                                                           \
    const LimberResult result_of_call = (call);                  \
    if (result_of_call != LIMBER_SUCCESS) return result_of_call; \
  } while (false)

LimberResult Skin(LimberContext* context, LimberRigId rig, LimberInstanceId instance) {
  LimberRigInfo info;
  LIMBER_TRY(limberGetRigInfo(context, rig, &info));
  const NotCounted own;
  std::vector<float> positions(size_t{info.num_vertices} * 3), normals(positions.size());
  LimberSkinDef skin = limberDefaultSkinDef();
  skin.num_vertices = info.num_vertices;
  skin.positions.data = positions.data();
  skin.normals.data = normals.data();
  return limberSkin(context, instance, &skin);
}

// What the guaranteed mode does not take.
LimberResult AskSoftly(LimberContext* context, LimberInstanceId instance, LimberSolveDef* solve) {
  solve->smoothing = 0.1;
  solve->time_step = 0.01;
  const float turned[4] = {0, 0, std::sin(0.1f), std::cos(0.1f)};
  return limberSetTargetRotation(context, instance, 0, turned, 10);
}

// Everything that an instance can be made to keep.
LimberResult UseInstance(LimberContext* context, LimberRigId rig, bool guaranteed,
                         LimberInstanceId* instance) {
  LimberInstanceDef def = limberDefaultInstanceDef();
  def.guaranteed = guaranteed ? 1 : 0;
  def.record = 1;
  LIMBER_TRY(limberCreateInstance(context, rig, &def, instance));
  LimberClipDef clip = limberDefaultClipDef();
  clip.time = 0.5;
  LIMBER_TRY(limberApplyClip(context, *instance, &clip));
  const LimberSkinPoint point = {{0, 0, 0}, {1, 0, 0}};
  int32_t grab = 0;
  LIMBER_TRY(limberGrab(context, *instance, &point, LIMBER_HELD_EXACTLY, &grab));
  LimberSolveDef solve = limberDefaultSolveDef();
  solve.guaranteed = def.guaranteed;
  solve.stretch_limit = 1.5;
  if (!guaranteed) LIMBER_TRY(AskSoftly(context, *instance, &solve));
  LIMBER_TRY(limberSolve(context, *instance, &solve, nullptr));
  return Skin(context, rig, *instance);
}

LimberResult UseAll(LimberContext* context) {
  LimberRigId rig, again;
  LimberInstanceId plain, guaranteed;
  LIMBER_TRY(Load(context, &rig));
  LIMBER_TRY(UseInstance(context, rig, false, &plain));
  LIMBER_TRY(UseInstance(context, rig, true, &guaranteed));
  LIMBER_TRY(Load(context, &again));
  LIMBER_TRY(limberSwitchRig(context, plain, again));
  return limberDestroyInstance(context, guaranteed);
}

class CapiMemory : public ::testing::Test {
 protected:
  LimberContext* MakeContext() {
    LimberContextDef def = limberDefaultContextDef();
    heap_.ServeTo(&def);
    LimberContext* context = nullptr;
    EXPECT_EQ(limberCreateContext(&def, &context), LIMBER_SUCCESS);
    return context;
  }

  static std::string MessageOf(const LimberContext* context) {
    char message[300] = "";
    limberGetLastMessage(context, message, sizeof message);
    return message;
  }

  void ExpectAllReturned() const {
    EXPECT_EQ(heap_.num_live(), 0u);
    EXPECT_EQ(heap_.num_wrong(), 0);
  }

  HostHeap heap_;
};

TEST_F(CapiMemory, WhatStays_ComesFromTheHost) {
  {
    LimberContext* warm_up = MakeContext();  // whatever is made once for a thread
    ASSERT_EQ(UseAll(warm_up), LIMBER_SUCCESS);
    limberDestroyContext(warm_up);
  }
  const int64_t before = LiveAllocations();
  LimberContext* context = MakeContext();
  ASSERT_EQ(UseAll(context), LIMBER_SUCCESS) << MessageOf(context);
  EXPECT_EQ(LiveAllocations(), before) << "something that stays came from the heap";
  EXPECT_GT(heap_.num_live(), 100u);
  limberDestroyContext(context);
  EXPECT_EQ(LiveAllocations(), before);
  ExpectAllReturned();
}

TEST_F(CapiMemory, WithoutAnAllocator_WhatStaysComesFromTheHeap) {
  const int64_t before = LiveAllocations();
  const LimberContextDef def = limberDefaultContextDef();
  LimberContext* context = nullptr;
  ASSERT_EQ(limberCreateContext(&def, &context), LIMBER_SUCCESS);
  ASSERT_EQ(UseAll(context), LIMBER_SUCCESS) << MessageOf(context);
  EXPECT_GT(LiveAllocations(), before + 100);
  limberDestroyContext(context);
}

TEST_F(CapiMemory, SteadyFrames_AskForNothing) {
  LimberContext* context = MakeContext();
  LimberRigId rig;
  LimberInstanceId instance;
  ASSERT_EQ(Load(context, &rig), LIMBER_SUCCESS);
  ASSERT_EQ(limberCreateInstance(context, rig, nullptr, &instance), LIMBER_SUCCESS);
  ASSERT_EQ(limberSolve(context, instance, nullptr, nullptr), LIMBER_SUCCESS);
  const int64_t made = heap_.num_made(), counted = AllocationCount();
  for (int frame = 0; frame < 10; ++frame)
    ASSERT_EQ(limberSolve(context, instance, nullptr, nullptr), LIMBER_SUCCESS);
  EXPECT_EQ(heap_.num_made(), made);
  EXPECT_EQ(AllocationCount(), counted);
  limberDestroyContext(context);
}

TEST_F(CapiMemory, AnyAllocationMayFail_AndNothingIsLost) {
  LimberContextDef def = limberDefaultContextDef();
  heap_.ServeTo(&def);
  for (const bool for_good : {false, true}) {
    int64_t survived = 0;
    bool done = false;
    for (; !done; ++survived) {
      ASSERT_LT(survived, 100'000);
      heap_.FailAfter(survived, for_good);
      LimberContext* context = nullptr;
      const LimberResult made = limberCreateContext(&def, &context);
      const LimberResult used = made == LIMBER_SUCCESS ? UseAll(context) : made;
      done = used == LIMBER_SUCCESS;
      if (!done) {
        ASSERT_EQ(used, LIMBER_ERROR_OUT_OF_MEMORY) << MessageOf(context);
      }
      // A recording ends for want of memory without failing the call: not yet the last allocation.
      done = done && heap_.num_made() > 0 && !heap_.HasFailed();
      limberDestroyContext(context);
      ASSERT_EQ(heap_.num_live(), 0u) << "after the failure of allocation " << survived;
    }
    EXPECT_GT(survived, 100);
  }
  ExpectAllReturned();
}

TEST_F(CapiMemory, ContextsSideBySide_KeepTheirOwn) {
  HostHeap other;
  LimberContextDef def = limberDefaultContextDef();
  other.ServeTo(&def);
  LimberContext* second = nullptr;
  LimberContext* first = MakeContext();
  ASSERT_EQ(limberCreateContext(&def, &second), LIMBER_SUCCESS);
  ASSERT_EQ(UseAll(second), LIMBER_SUCCESS);
  const size_t of_second = other.num_live();
  ASSERT_EQ(UseAll(first), LIMBER_SUCCESS);
  EXPECT_EQ(other.num_live(), of_second);
  limberDestroyContext(second);
  EXPECT_EQ(other.num_live(), 0u);
  EXPECT_GT(heap_.num_live(), 100u);
  limberDestroyContext(first);
  ExpectAllReturned();
}

TEST_F(CapiMemory, OnOtherThreads_TheHostIsAskedAsWell) {
  LimberContextDef def = limberDefaultContextDef();
  heap_.ServeTo(&def);
  // A job system of one thread that is not the caller's, and counts what it took itself.
  int64_t kept_by_the_thread = 0;
  def.tasks_user = &kept_by_the_thread;
  def.run_tasks = [](void* user, LimberTask task, void* data, uint32_t count) {
    std::thread([=] {
      const int64_t before = LiveAllocations();
      for (uint32_t i = 0; i < count; ++i)
        task(data, i);
      *static_cast<int64_t*>(user) += LiveAllocations() - before;
    }).join();
  };
  LimberContext* context = nullptr;
  ASSERT_EQ(limberCreateContext(&def, &context), LIMBER_SUCCESS);
  LimberRigId rig;
  ASSERT_EQ(Load(context, &rig), LIMBER_SUCCESS);
  std::vector<LimberInstanceId> crowd(5);
  for (LimberInstanceId& instance : crowd)
    ASSERT_EQ(limberCreateInstance(context, rig, nullptr, &instance), LIMBER_SUCCESS);
  const int64_t made = heap_.num_made();
  LimberSolveDef solve = limberDefaultSolveDef();
  solve.smoothing = 0.1;
  ASSERT_EQ(limberSolveMany(context, crowd.data(), 5, &solve, nullptr, nullptr), LIMBER_SUCCESS);
  EXPECT_GT(heap_.num_made(), made) << "the first solve that smooths makes something";
  EXPECT_EQ(kept_by_the_thread, 0);
  limberDestroyContext(context);
  ExpectAllReturned();
}

TEST_F(CapiMemory, AnAllocatorThatIsNone_IsRefused) {
  LimberContext* context = nullptr;
  LimberContextDef def = limberDefaultContextDef();
  heap_.ServeTo(&def);
  def.free = nullptr;
  EXPECT_EQ(limberCreateContext(&def, &context), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(MessageOf(nullptr).find("free: one of them is null"), std::string::npos);
  heap_.ServeTo(&def);
  def.allocate = nullptr;
  EXPECT_EQ(limberCreateContext(&def, &context), LIMBER_ERROR_INVALID_ARGUMENT);

  alignas(64) static unsigned char room[256];
  def = limberDefaultContextDef();
  def.allocate = [](void*, size_t, size_t) -> void* { return room + 8; };
  def.free = [](void*, void* memory, size_t, size_t) { EXPECT_EQ(memory, room + 8); };
  EXPECT_EQ(limberCreateContext(&def, &context), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(MessageOf(nullptr).find("not aligned"), std::string::npos) << MessageOf(nullptr);

  def.allocate = [](void*, size_t, size_t) -> void* { return nullptr; };
  EXPECT_EQ(limberCreateContext(&def, &context), LIMBER_ERROR_OUT_OF_MEMORY);
  EXPECT_EQ(context, nullptr);
}

TEST_F(CapiMemory, CallersOfAnOlderHeader_HaveTheHeap) {
  LimberContextDef def = limberDefaultContextDef();
  heap_.ServeTo(&def);
  def.struct_size = offsetof(LimberContextDef, allocate);
  LimberContext* context = nullptr;
  ASSERT_EQ(limberCreateContext(&def, &context), LIMBER_SUCCESS);
  ASSERT_EQ(UseAll(context), LIMBER_SUCCESS) << MessageOf(context);
  EXPECT_EQ(heap_.num_made(), 0);
  limberDestroyContext(context);
}

}  // namespace
}  // namespace limber::test
