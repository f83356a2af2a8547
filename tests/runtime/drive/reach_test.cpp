#include "drive/reach.h"

#include "drive_fixture.h"

#include <random>

namespace limber::test {
namespace {

class Reach : public ::testing::Test {
 protected:
  void SetUp() override {
    rig_ = LoadTube();
    ASSERT_NE(rig_, nullptr);
    auto state = PoseState::Create(rig_);
    ASSERT_TRUE(state.ok());
    state_ = std::make_unique<PoseState>(std::move(*state));
    right_ = rig_->FindHandle("right");
  }

  // Mesh units.
  float ReachOf(int a, int b) const {
    const auto h = static_cast<size_t>(rig_->num_handles());
    return rig_->tables().space.scale *
           rig_->tables().handle_reach[static_cast<size_t>(a) * h + static_cast<size_t>(b)];
  }

  float LargestExcess(Vec3 point, double limit) const {
    float excess = -1e30f;
    for (int other = 0; other < rig_->num_handles(); ++other) {
      if (other == right_ || !state_->is_pinned(other)) continue;
      excess = std::max(excess, Distance(point, state_->target(other)) -
                                    static_cast<float>(limit) * ReachOf(right_, other));
    }
    return excess;
  }

  std::shared_ptr<const Rig> rig_;
  std::unique_ptr<PoseState> state_;
  int right_ = 0;
};

TEST_F(Reach, GoalsWithin_StayWhereTheyAre) {
  const Vec3 at = state_->target(right_);
  EXPECT_EQ(ClampToReach(*state_, right_, 1, at), at);
  const Vec3 near = {at.x - 0.1f, at.y + 0.05f, at.z};
  EXPECT_EQ(ClampToReach(*state_, right_, 1, near), near);
  const Vec3 far = {1e6f, 0, 0};
  EXPECT_EQ(ClampToReach(*state_, right_, 0, far), far);
}

TEST_F(Reach, OneHandleThatHoldsBack_GivesTheNearestPoint) {
  for (int other = 0; other < rig_->num_handles(); ++other) {
    const bool is_left = other == rig_->FindHandle("left");
    if (!is_left && other != right_) {
      ASSERT_TRUE(state_->Unpin(other).ok());
    }
  }
  const int left = rig_->FindHandle("left");
  const Vec3 centre = state_->target(left), goal = {9, 4, -2};
  const Vec3 got = ClampToReach(*state_, right_, 1.5, goal);
  const float radius = 1.5f * ReachOf(right_, left), length = Distance(goal, centre);
  EXPECT_NEAR(got.x, centre.x + radius / length * (goal.x - centre.x), 1e-5);
  EXPECT_NEAR(got.y, centre.y + radius / length * (goal.y - centre.y), 1e-5);
  EXPECT_NEAR(got.z, centre.z + radius / length * (goal.z - centre.z), 1e-5);
}

TEST_F(Reach, AnyGoals_EndWithinReachAndMoveNoFurtherThanTheyDo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(-6, 6);
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = {number(random), number(random), number(random)};
    const float near = i % 2 == 0 ? 0.02f : 1.0f;
    const Vec3 b = {a.x + near * number(random), a.y + near * number(random), a.z};
    const Vec3 held_a = ClampToReach(*state_, right_, 1, a);
    const Vec3 held_b = ClampToReach(*state_, right_, 1, b);
    EXPECT_LT(LargestExcess(held_a, 1), 1e-4 * rig_->diagonal());
    EXPECT_LE(Distance(held_a, held_b), Distance(a, b) + 1e-4f * rig_->diagonal());
  }
}

}  // namespace
}  // namespace limber::test
