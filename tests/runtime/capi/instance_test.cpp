// The C interface gives what the runtime behind it gives, to the bit.
#include "c_caller.h"
#include "capi_fixture.h"
#include "core/vector.h"
#include "load/rig_loader.h"
#include "skin/cpu_skinner.h"
#include "solve/pose_solver.h"
#include "support/counting_allocator.h"

#include <algorithm>
#include <cstring>
#include <thread>

namespace limber::test {
namespace {

// As a host's vertex buffer: position, normal, tangent and what is the host's own.
struct HostVertex {
  float position[3], texcoord[2], normal[3], tangent[4];
};

LimberSkinDef SkinInto(Vector<HostVertex>* vertices) {
  LimberSkinDef def = limberDefaultSkinDef();
  def.num_vertices = uint32_t(vertices->size());
  def.positions = {vertices->data()->position, sizeof(HostVertex)};
  def.normals = {vertices->data()->normal, sizeof(HostVertex)};
  def.tangents = {vertices->data()->tangent, sizeof(HostVertex)};
  return def;
}

Vec3 Target(const PoseState& state, int handle, float by) {
  const Vec3 at = state.rig().tables().handles[size_t(handle)].rest_position;
  const float step = by * state.rig().diagonal();
  return {at.x + step, at.y - 0.5f * step, at.z};
}

TEST_F(CapiTest, SolvesAndSkinsAsTheRuntime) {
  const auto rig = LoadRig(BakedTube());
  ASSERT_TRUE(rig.ok());
  PoseState state = PoseState::Create(*rig).value();
  CpuSkinner skinner = CpuSkinner::Create((*rig)->mesh(), (*rig)->tables().space).value();
  Vector<HostVertex> vertices(info_.num_vertices);
  for (HostVertex& vertex : vertices)
    vertex.texcoord[0] = vertex.texcoord[1] = 7;
  LimberSkinDef skin = SkinInto(&vertices);
  float bounds[2][3] = {};
  skin.bounds = bounds[0];
  LimberSolveDef def = limberDefaultSolveDef();
  def.iterations = 3;
  PoseOptions options;
  options.iterations = 3;
  for (int frame = 1; frame <= 5; ++frame) {
    for (int handle = 0; handle < info_.num_handles; ++handle) {
      if (!state.is_pinned(handle)) continue;
      const Vec3 target = Target(state, handle, handle == 0 ? 0.02f * float(frame) : 0);
      const float position[] = {target.x, target.y, target.z};
      ASSERT_TRUE(state.SetTarget(handle, target).ok());
      ASSERT_EQ(limberSetTarget(context_, instance_, handle, position), LIMBER_SUCCESS);
    }
    PoseReport expected;
    LimberSolveReport report;
    ASSERT_TRUE(state.Solve(options, &expected).ok());
    ASSERT_EQ(limberSolve(context_, instance_, &def, &report), LIMBER_SUCCESS) << Message();
    EXPECT_EQ(report.energy, expected.energy);
    EXPECT_EQ(report.iterations, expected.iterations);
    ASSERT_TRUE(skinner.Skin(state.transforms()).ok());
    ASSERT_EQ(limberSkin(context_, instance_, &skin), LIMBER_SUCCESS) << Message();
    const DeformedMesh mesh = skinner.result();
    for (size_t v = 0; v < vertices.size(); ++v) {
      ASSERT_EQ(std::memcmp(vertices[v].position, &mesh.positions[v], sizeof(Vec3)), 0);
      ASSERT_EQ(std::memcmp(vertices[v].normal, &mesh.normals[v], sizeof(Vec3)), 0);
      ASSERT_EQ(std::memcmp(vertices[v].tangent, &mesh.tangents[v], sizeof(Tangent)), 0);
      ASSERT_EQ(vertices[v].texcoord[0], 7) << "what is the host's stays";
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto less = [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; };
      const auto [low, high] =
          std::minmax_element(mesh.positions.begin(), mesh.positions.end(), less);
      ASSERT_EQ(bounds[0][axis], (*low)[axis]);
      ASSERT_EQ(bounds[1][axis], (*high)[axis]);
    }
  }
  Vector<double> weights(size_t(info_.num_groups) * size_t(info_.num_shapes));
  ASSERT_EQ(limberGetBlendWeights(context_, instance_, weights.data(), weights.size()),
            LIMBER_SUCCESS);
  EXPECT_TRUE(std::equal(weights.begin(), weights.end(), state.blend_weights().begin()));
}

TEST_F(CapiTest, PositionsAlone_AreTheSamePositions) {
  Vector<HostVertex> all(info_.num_vertices);
  Vector<float> positions(3 * info_.num_vertices);
  const LimberSkinDef skin = SkinInto(&all);
  LimberSkinDef alone = limberDefaultSkinDef();
  alone.num_vertices = info_.num_vertices;
  alone.positions.data = positions.data();
  ASSERT_EQ(limberSkin(context_, instance_, &skin), LIMBER_SUCCESS);
  ASSERT_EQ(limberSkin(context_, instance_, &alone), LIMBER_SUCCESS);
  for (size_t v = 0; v < all.size(); ++v)
    EXPECT_EQ(std::memcmp(all[v].position, &positions[3 * v], 3 * sizeof(float)), 0);
}

TEST_F(CapiTest, HandlesAreKnownByName) {
  for (int32_t handle = 0; handle < info_.num_handles; ++handle) {
    LimberHandleInfo handle_info;
    ASSERT_EQ(limberGetHandleInfo(context_, rig_, handle, &handle_info), LIMBER_SUCCESS);
    int32_t found = -1;
    ASSERT_EQ(limberFindHandle(context_, rig_, handle_info.name, &found), LIMBER_SUCCESS);
    EXPECT_EQ(found, handle);
  }
}

TEST_F(CapiTest, InstancesOutliveTheirRigsId) {
  ASSERT_EQ(limberDestroyRig(context_, rig_), LIMBER_SUCCESS);
  EXPECT_EQ(limberGetRigInfo(context_, rig_, &info_), LIMBER_ERROR_STALE_ID);
  EXPECT_EQ(limberSolve(context_, instance_, nullptr, nullptr), LIMBER_SUCCESS);
  LimberInstanceId other;
  EXPECT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_ERROR_STALE_ID);
}

TEST_F(CapiTest, ResetToRest_IsTheRestPose) {
  Vector<HostVertex> before(info_.num_vertices), after(info_.num_vertices);
  LimberSkinDef skin = SkinInto(&before);
  ASSERT_EQ(limberSkin(context_, instance_, &skin), LIMBER_SUCCESS);
  const float far[] = {0.3f * info_.diagonal, 0, 0}, turn[] = {0, 0, 0.5f, 1};
  ASSERT_EQ(limberSetTarget(context_, instance_, 0, far), LIMBER_SUCCESS) << Message();
  ASSERT_EQ(limberSetTargetRotation(context_, instance_, 0, turn, LIMBER_HELD_EXACTLY),
            LIMBER_SUCCESS)
      << Message();
  ASSERT_EQ(limberSolve(context_, instance_, nullptr, nullptr), LIMBER_SUCCESS);
  ASSERT_EQ(limberResetToRest(context_, instance_), LIMBER_SUCCESS);
  LimberSolveDef def = limberDefaultSolveDef();
  def.iterations = 500;
  ASSERT_EQ(limberSolve(context_, instance_, &def, nullptr), LIMBER_SUCCESS);
  skin = SkinInto(&after);
  ASSERT_EQ(limberSkin(context_, instance_, &skin), LIMBER_SUCCESS);
  for (size_t v = 0; v < before.size(); ++v) {
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(after[v].position[i], before[v].position[i], 1e-4f * info_.diagonal);
  }
}

// Weights, shapes and the solver's scratch are the rig's: an instance is a small thing beside them.
TEST_F(CapiTest, AnotherInstance_TakesLittle) {
  Vector<HostVertex> vertices(info_.num_vertices);
  const LimberSkinDef skin = SkinInto(&vertices);
  ASSERT_EQ(limberSkin(context_, instance_, &skin), LIMBER_SUCCESS);
  ASSERT_EQ(limberSolve(context_, instance_, nullptr, nullptr), LIMBER_SUCCESS);
  const int64_t before = AllocatedBytes();
  LimberInstanceId other;
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_SUCCESS);
  ASSERT_EQ(limberSolve(context_, other, nullptr, nullptr), LIMBER_SUCCESS);
  ASSERT_EQ(limberSkin(context_, other, &skin), LIMBER_SUCCESS);
  EXPECT_LE(AllocatedBytes() - before, 16 * 1024);
  const int64_t count = AllocationCount();
  for (int frame = 0; frame < 10; ++frame) {
    const float target[] = {0.01f * float(frame) * info_.diagonal, 0, 0};
    for (const LimberInstanceId instance : {instance_, other}) {
      ASSERT_EQ(limberSetTarget(context_, instance, 0, target), LIMBER_SUCCESS);
      ASSERT_EQ(limberSolve(context_, instance, nullptr, nullptr), LIMBER_SUCCESS);
      ASSERT_EQ(limberSkin(context_, instance, &skin), LIMBER_SUCCESS);
    }
  }
  EXPECT_EQ(AllocationCount() - count, 0);
}

// The leak sanitizer looks at what this leaves behind.
TEST(CapiCycles, CreatedAndDestroyedAgainAndAgain_LeaveNothing) {
  const Vector<char> file = ReadBytes(BakedTube());
  for (int cycle = 0; cycle < 30; ++cycle) {
    LimberContextDef def = limberDefaultContextDef();
    def.num_threads = 2;
    LimberContext* context = nullptr;
    ASSERT_EQ(limberCreateContext(&def, &context), LIMBER_SUCCESS);
    LimberRigId rig;
    ASSERT_EQ(limberLoadRigFromMemory(context, file.data(), file.size(), "tube", nullptr, &rig),
              LIMBER_SUCCESS);
    Vector<LimberInstanceId> instances(4);
    for (LimberInstanceId& instance : instances)
      ASSERT_EQ(limberCreateInstance(context, rig, nullptr, &instance), LIMBER_SUCCESS);
    ASSERT_EQ(limberSolveMany(context, instances.data(), 4, nullptr, nullptr, nullptr),
              LIMBER_SUCCESS);
    if (cycle % 2 == 0) {  // else all goes with the context
      ASSERT_EQ(limberDestroyRig(context, rig), LIMBER_SUCCESS);
      for (const LimberInstanceId instance : instances)
        ASSERT_EQ(limberDestroyInstance(context, instance), LIMBER_SUCCESS);
    }
    limberDestroyContext(context);
  }
}

// Instances of one rig on two threads, while a third loads rigs and makes and ends instances.
TEST_F(CapiTest, ManyThreads_OneInstanceEach_SameBits) {
  constexpr int kFrames = 200;
  const auto run = [&](LimberInstanceId instance, Vector<float>* positions) {
    LimberSkinDef skin = limberDefaultSkinDef();
    positions->resize(3 * info_.num_vertices);
    skin.num_vertices = info_.num_vertices;
    skin.positions.data = positions->data();
    for (int frame = 0; frame < kFrames; ++frame) {
      const float target[] = {0.001f * float(frame) * info_.diagonal, 0, 0};
      EXPECT_EQ(limberSetTarget(context_, instance, 0, target), LIMBER_SUCCESS);
      EXPECT_EQ(limberSolve(context_, instance, nullptr, nullptr), LIMBER_SUCCESS);
      EXPECT_EQ(limberSkin(context_, instance, &skin), LIMBER_SUCCESS);
    }
  };
  Vector<float> alone, first, second;
  LimberInstanceId others[2];
  for (LimberInstanceId& other : others)
    ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_SUCCESS);
  run(instance_, &alone);
  std::thread one([&] { run(others[0], &first); });
  std::thread two([&] { run(others[1], &second); });
  for (int i = 0; i < 20; ++i) {
    LimberRigId rig;
    LimberInstanceId brief;
    ASSERT_EQ(limberLoadRig(context_, BakedTube().c_str(), nullptr, &rig), LIMBER_SUCCESS);
    ASSERT_EQ(limberCreateInstance(context_, rig, nullptr, &brief), LIMBER_SUCCESS);
    ASSERT_EQ(limberDestroyRig(context_, rig), LIMBER_SUCCESS);
    ASSERT_EQ(limberDestroyInstance(context_, brief), LIMBER_SUCCESS);
  }
  one.join();
  two.join();
  EXPECT_EQ(first, alone);
  EXPECT_EQ(second, alone);
}

TEST(CapiFromC, DragsACharacter) {
  const Vector<char> bytes = ReadBytes(BakedTube());
  ASSERT_FALSE(bytes.empty());
  float moved[3];
  uint32_t num_vertices = 0;
  EXPECT_EQ(DragInC(bytes.data(), bytes.size(), moved, &num_vertices), 0);
  EXPECT_GT(num_vertices, 10u);
}

}  // namespace
}  // namespace limber::test
