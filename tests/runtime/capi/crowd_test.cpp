// Many instances at once: the same bits on any number of threads, and each failure its own.
#include "capi_fixture.h"
#include "core/vector.h"

#include <atomic>
#include <thread>

namespace limber::test {
namespace {

constexpr uint32_t kCrowd = 12;
constexpr int kFrames = 20;

// A host's job system that starts a thread for each of two halves; counts what it ran.
struct Host {
  std::atomic<uint32_t> rounds = 0;
  std::atomic<int> loops = 0;

  static void Run(void* user, LimberTask task, void* data, uint32_t count) {
    Host* host = static_cast<Host*>(user);
    ++host->loops;
    const auto half = [=](uint32_t first) {
      for (uint32_t i = first; i < count; i += 2, ++host->rounds)
        task(data, i);
    };
    std::thread other(half, 1);
    half(0);
    other.join();
  }
};

// Targets differ by instance and frame; the skins of the last frame, one after the other.
Vector<float> PlayCrowd(const LimberContextDef& def) {
  LimberContext* context = nullptr;
  EXPECT_EQ(limberCreateContext(&def, &context), LIMBER_SUCCESS);
  LimberRigId rig;
  EXPECT_EQ(limberLoadRig(context, BakedTube().c_str(), nullptr, &rig), LIMBER_SUCCESS);
  LimberRigInfo info;
  EXPECT_EQ(limberGetRigInfo(context, rig, &info), LIMBER_SUCCESS);
  Vector<LimberInstanceId> instances(kCrowd);
  Vector<float> positions(size_t{3} * info.num_vertices * kCrowd);
  Vector<LimberSkinDef> skins(kCrowd, limberDefaultSkinDef());
  for (uint32_t i = 0; i < kCrowd; ++i) {
    EXPECT_EQ(limberCreateInstance(context, rig, nullptr, &instances[i]), LIMBER_SUCCESS);
    skins[i].num_vertices = info.num_vertices;
    skins[i].positions.data = positions.data() + size_t{3} * info.num_vertices * i;
  }
  Vector<LimberSolveReport> reports(kCrowd);
  Vector<LimberResult> results(kCrowd, LIMBER_ERROR_INTERNAL);
  for (int frame = 0; frame < kFrames; ++frame) {
    for (uint32_t i = 0; i < kCrowd; ++i) {
      const float target[] = {0.002f * float(frame) * float(i) * info.diagonal, 0, 0};
      EXPECT_EQ(limberSetTarget(context, instances[i], 0, target), LIMBER_SUCCESS);
    }
    EXPECT_EQ(
        limberSolveMany(context, instances.data(), kCrowd, nullptr, reports.data(), results.data()),
        LIMBER_SUCCESS);
    for (uint32_t i = 0; i < kCrowd; ++i) {
      EXPECT_EQ(results[i], LIMBER_SUCCESS);
      EXPECT_EQ(reports[i].iterations, 1);
    }
  }
  EXPECT_EQ(limberSkinMany(context, instances.data(), kCrowd, skins.data(), nullptr),
            LIMBER_SUCCESS);
  limberDestroyContext(context);
  return positions;
}

TEST(CapiCrowd, AnyNumberOfThreads_GivesTheSameBits) {
  LimberContextDef def = limberDefaultContextDef();
  def.num_threads = 1;
  const Vector<float> one = PlayCrowd(def);
  EXPECT_NE(Vector<float>(one.begin(), one.begin() + 30), Vector<float>(one.end() - 30, one.end()));
  for (const int32_t threads : {2, 4, 0}) {
    def.num_threads = threads;
    EXPECT_EQ(PlayCrowd(def), one) << threads;
  }
}

TEST(CapiCrowd, HostsJobSystem_DoesTheRounds) {
  LimberContextDef def = limberDefaultContextDef();
  def.num_threads = 1;
  const Vector<float> one = PlayCrowd(def);
  Host host;
  def.run_tasks = Host::Run;
  def.tasks_user = &host;
  EXPECT_EQ(PlayCrowd(def), one);
  EXPECT_EQ(host.loops, kFrames + 1);
  EXPECT_EQ(host.rounds, kCrowd * (kFrames + 1));
}

// One that is gone has its own result; the others are solved.
TEST_F(CapiTest, Crowd_OneThatIsGone_DoesNotStopTheOthers) {
  LimberInstanceId gone, other;
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &gone), LIMBER_SUCCESS);
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_SUCCESS);
  ASSERT_EQ(limberDestroyInstance(context_, gone), LIMBER_SUCCESS);
  const LimberInstanceId crowd[] = {instance_, gone, other};
  LimberSolveReport reports[3] = {};
  LimberResult results[3] = {-1, -1, -1};
  EXPECT_EQ(limberSolveMany(context_, crowd, 3, nullptr, reports, results), LIMBER_ERROR_STALE_ID);
  EXPECT_EQ(results[0], LIMBER_SUCCESS);
  EXPECT_EQ(results[1], LIMBER_ERROR_STALE_ID);
  EXPECT_EQ(results[2], LIMBER_SUCCESS);
  EXPECT_EQ(reports[0].iterations + 10 * reports[1].iterations + 100 * reports[2].iterations, 101);
  EXPECT_NE(Message().find("limberSolveMany: instance"), std::string::npos) << Message();
}

TEST_F(CapiTest, Crowd_Misuse_IsRefusedBeforeAnythingIsDone) {
  LimberInstanceId other;
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_SUCCESS);
  const LimberInstanceId twice[] = {instance_, other, instance_};
  LimberResult results[3] = {-1, -1, -1};
  EXPECT_EQ(limberSolveMany(context_, twice, 3, nullptr, nullptr, results),
            LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(Message().find("instances[2]"), std::string::npos) << Message();
  EXPECT_EQ(results[1], -1);
  EXPECT_EQ(limberSolveMany(context_, twice, 2, nullptr, nullptr, nullptr), LIMBER_SUCCESS)
      << "the marks are gone again";
  EXPECT_EQ(limberSolveMany(context_, nullptr, 2, nullptr, nullptr, nullptr),
            LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(limberSolveMany(context_, nullptr, 0, nullptr, nullptr, nullptr), LIMBER_SUCCESS);
  EXPECT_EQ(limberSolveMany(context_, twice, UINT32_MAX, nullptr, nullptr, nullptr),
            LIMBER_ERROR_LIMIT_EXCEEDED);
  EXPECT_EQ(limberSolveMany(nullptr, twice, 2, nullptr, nullptr, nullptr),
            LIMBER_ERROR_INVALID_ARGUMENT);
  LimberSolveDef def = {};
  EXPECT_EQ(limberSolveMany(context_, twice, 2, &def, nullptr, nullptr),
            LIMBER_ERROR_STRUCT_NOT_DEFAULT);
  EXPECT_EQ(limberSkinMany(context_, twice, 2, nullptr, nullptr), LIMBER_ERROR_INVALID_ARGUMENT);
  LimberSkinDef skins[] = {limberDefaultSkinDef(), limberDefaultSkinDef()};  // no vertices
  EXPECT_EQ(limberSkinMany(context_, twice, 2, skins, results), LIMBER_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(results[1], LIMBER_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace limber::test
