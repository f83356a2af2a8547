// Pins, stiffness, rotations and grabs through the C interface, against the runtime's own.
#include "capi_fixture.h"
#include "load/rig_loader.h"
#include "solve/pose_solver.h"

#include <functional>

namespace limber::test {
namespace {

class CapiHolds : public CapiTest {
 protected:
  void SetUp() override {
    CapiTest::SetUp();
    const auto rig = LoadRig(BakedTube());
    ASSERT_TRUE(rig.ok());
    state_.emplace(PoseState::Create(*rig).value());
  }

  // Both solve; the handles are then at the same places, to the bit.
  void ExpectSamePlaces() {
    for (int frame = 0; frame < 5; ++frame) {
      ASSERT_TRUE(state_->Solve({}, nullptr).ok());
      ASSERT_EQ(limberSolve(context_, instance_, nullptr, nullptr), LIMBER_SUCCESS) << Message();
    }
    for (int32_t handle = 0; handle < info_.num_handles; ++handle) {
      LimberHandleState of;
      ASSERT_EQ(limberGetHandle(context_, instance_, handle, &of), LIMBER_SUCCESS) << Message();
      SkinPoint point;
      point.vertices.fill(state_->rig().tables().handles[size_t(handle)].vertex);
      const Vec3 place = state_->Place(point), target = state_->target(handle);
      EXPECT_EQ((Vec3{of.position[0], of.position[1], of.position[2]}), place) << handle;
      EXPECT_EQ((Vec3{of.target[0], of.target[1], of.target[2]}), target) << handle;
      EXPECT_EQ(of.pinned == 1, state_->is_pinned(handle)) << handle;
    }
  }

  LimberSkinPoint FirstTriangle() const {
    return {{info_.triangles[0], info_.triangles[1], info_.triangles[2]}, {0.25f, 0.25f, 0.5f}};
  }

  // A draw vertex's number in the solver.
  uint32_t Solve(uint32_t vertex) const { return state_->rig().mesh().solve_vertex[vertex]; }

  std::optional<PoseState> state_;
};

TEST_F(CapiHolds, PinsStiffnessAndWeights_AreTheRuntimes) {
  const float far = 0.4f * info_.diagonal, target[] = {far, far, 0};
  ASSERT_TRUE(state_->Unpin(1).ok() && state_->SetTarget(0, {far, far, 0}).ok());
  ASSERT_TRUE(state_->SetStiffness(0, 3).ok() && state_->SetWeight(0, 2).ok());
  ASSERT_EQ(limberUnpin(context_, instance_, 1), LIMBER_SUCCESS);
  ASSERT_EQ(limberSetTarget(context_, instance_, 0, target), LIMBER_SUCCESS);
  ASSERT_EQ(limberSetStiffness(context_, instance_, 0, 3), LIMBER_SUCCESS);
  ASSERT_EQ(limberSetWeight(context_, instance_, 0, 2), LIMBER_SUCCESS);
  ExpectSamePlaces();
  ASSERT_TRUE(state_->Pin(1).ok() && state_->SetStiffness(0, kHeldExactly).ok());
  ASSERT_EQ(limberPin(context_, instance_, 1), LIMBER_SUCCESS);
  ASSERT_EQ(limberSetStiffness(context_, instance_, 0, LIMBER_HELD_EXACTLY), LIMBER_SUCCESS);
  ExpectSamePlaces();
}

TEST_F(CapiHolds, SoftRotation_IsTheRuntimes) {
  const float turn[] = {0, 0.3f, 0, 1};
  ASSERT_TRUE(state_->SetRotation(0, {0, 0.3f, 0, 1}, 5).ok());
  ASSERT_EQ(limberSetTargetRotation(context_, instance_, 0, turn, 5), LIMBER_SUCCESS);
  ExpectSamePlaces();
}

TEST_F(CapiHolds, GrabbedSkin_FollowsItsTarget) {
  const LimberSkinPoint point = FirstTriangle();
  float place[3], after[3];
  int32_t grab = -1;
  ASSERT_EQ(limberGetPlace(context_, instance_, &point, place), LIMBER_SUCCESS) << Message();
  ASSERT_EQ(limberGrab(context_, instance_, &point, LIMBER_HELD_EXACTLY, &grab), LIMBER_SUCCESS)
      << Message();
  place[0] += 0.02f * info_.diagonal;
  ASSERT_EQ(limberSetGrabTarget(context_, instance_, grab, place), LIMBER_SUCCESS) << Message();
  const Result<int> expected =
      state_->Grab({{Solve(point.vertices[0]), Solve(point.vertices[1]), Solve(point.vertices[2])},
                    {0.25f, 0.25f, 0.5f}});
  ASSERT_TRUE(expected.ok());
  ASSERT_TRUE(state_->SetGrabTarget(*expected, {place[0], place[1], place[2]}).ok());
  ExpectSamePlaces();
  ASSERT_EQ(limberGetPlace(context_, instance_, &point, after), LIMBER_SUCCESS);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(after[i], place[i], 1e-4f * info_.diagonal);
  ASSERT_EQ(limberRelease(context_, instance_, grab), LIMBER_SUCCESS);
  ASSERT_TRUE(state_->Release(*expected).ok());
  ExpectSamePlaces();
  EXPECT_EQ(limberRelease(context_, instance_, grab), LIMBER_ERROR_INVALID_ARGUMENT);
}

TEST_F(CapiHolds, RoomForGrabs_IsTheDefs) {
  LimberInstanceDef def = limberDefaultInstanceDef();
  def.max_grabs = 1;
  LimberInstanceId one;
  ASSERT_EQ(limberCreateInstance(context_, rig_, &def, &one), LIMBER_SUCCESS);
  const LimberSkinPoint point = FirstTriangle();
  int32_t grab = -1;
  EXPECT_EQ(limberGrab(context_, one, &point, 5, &grab), LIMBER_SUCCESS) << Message();
  EXPECT_EQ(limberGrab(context_, one, &point, 5, &grab), LIMBER_ERROR_LIMIT_EXCEEDED);
}

TEST_F(CapiHolds, Misuse_IsRefused) {
  LimberSkinPoint point = FirstTriangle();
  const LimberSkinPoint bad_sum = {{0, 0, 0}, {1, 1, 0}},
                        bad_vertex = {{info_.num_vertices, 0, 0}, {1, 0, 0}};
  int32_t grab = 0;
  float place[3];
  LimberHandleState state;
  const std::function<LimberResult()> calls[] = {
      [&] { return limberPin(context_, instance_, -1); },
      [&] { return limberUnpin(context_, instance_, info_.num_handles); },
      [&] { return limberSetStiffness(context_, instance_, 0, -1); },
      [&] { return limberSetStiffness(context_, instance_, 0, NAN); },
      [&] { return limberSetWeight(context_, instance_, 0, 0); },
      [&] { return limberGetHandle(context_, instance_, 0, nullptr); },
      [&] { return limberGetHandle(context_, instance_, -1, &state); },
      [&] { return limberGrab(context_, instance_, nullptr, 1, &grab); },
      [&] { return limberGrab(context_, instance_, &point, 1, nullptr); },
      [&] { return limberGrab(context_, instance_, &bad_sum, 1, &grab); },
      [&] { return limberGrab(context_, instance_, &bad_vertex, 1, &grab); },
      [&] { return limberGrab(context_, instance_, &point, 0, &grab); },
      [&] { return limberSetGrabTarget(context_, instance_, 7, place); },
      [&] { return limberSetGrabTarget(context_, instance_, 7, nullptr); },
      [&] { return limberGetPlace(context_, instance_, &bad_vertex, place); },
      [&] { return limberGetPlace(context_, instance_, &point, nullptr); },
  };
  for (size_t i = 0; i < std::size(calls); ++i) {
    EXPECT_EQ(calls[i](), LIMBER_ERROR_INVALID_ARGUMENT) << i << ": " << Message();
    EXPECT_EQ(log_.size(), i + 1) << i;
  }
  const LimberInstanceId none = {};
  EXPECT_EQ(limberPin(context_, none, 0), LIMBER_ERROR_STALE_ID);
  EXPECT_EQ(limberGrab(context_, none, &point, 1, &grab), LIMBER_ERROR_STALE_ID);
  ExpectSamePlaces();
}

}  // namespace
}  // namespace limber::test
