// What a PoseState does beyond the paper's plain alternation, each where it was asked for: motion
// smooth in time, limits on stretch, the guaranteed mode.
#include "core/vector.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"
#include "support/counting_allocator.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

using Eigen::Vector3d;

class PoseOptionsTest : public testing::Test {
 protected:
  void Make(const bake::RawCharacter& raw) {
    rig_ = test::BakeInMemory(raw);
    ASSERT_NE(rig_, nullptr);
    model_ = PoseModel::Create(rig_).value();
  }

  PoseState MakeState(PoseRoom room = {}) const { return PoseState::Create(model_, room).value(); }

  static PoseOptions Settled() {
    PoseOptions options;
    options.iterations = 2000;
    options.settle_tolerance = 1e-10;
    return options;
  }

  uint32_t Vertex(int handle) const {
    return rig_->tables().handles[static_cast<size_t>(handle)].vertex;
  }

  Vec3 Place(const PoseState& state, int handle) const {
    const uint32_t v = Vertex(handle);
    return state.Place({{v, v, v}, {1, 0, 0}});
  }

  static double Distance(Vec3 a, Vec3 b) {
    return std::hypot(double{a.x} - double{b.x}, double{a.y} - double{b.y},
                      double{a.z} - double{b.z});
  }

  std::shared_ptr<const Rig> rig_;
  std::shared_ptr<const PoseModel> model_;
};

// The square, whose right handle goes from one example to the next and further, evenly.
class SmoothingTest : public PoseOptionsTest {
 protected:
  void SetUp() override {
    Make(test::MakeStretchSquare(8));
    right_ = rig_->FindHandle("right");
    from_ = Place(MakeState(), right_);
  }

  Vec3 Target(double seconds) const {
    return {from_.x + static_cast<float>(std::min(1.4 * seconds, 1.4)), from_.y, from_.z};
  }

  // Mean weight of the middle example at each tenth of a second, and the state in the end.
  Vector<double> Drag(double rate, double smoothing, PoseState* state) const {
    PoseOptions options = Settled();
    options.smoothing = smoothing;
    options.time_step = 1 / rate;
    Vector<double> weights;
    const int frames = static_cast<int>(2 * rate), between = static_cast<int>(rate / 10);
    for (int frame = 1; frame <= frames; ++frame) {
      EXPECT_TRUE(state->SetTarget(right_, Target(frame / rate)).ok());
      EXPECT_TRUE(state->Solve(options, nullptr).ok());
      EXPECT_LT(Distance(Place(*state, right_), state->target(right_)), 1e-5) << frame;
      double mean = 0;
      for (size_t g = 0; g < static_cast<size_t>(rig_->num_groups()); ++g)
        mean += state->blend_weights()[g * 3 + 1] / rig_->num_groups();
      if (frame % between == 0) weights.push_back(mean);
    }
    return weights;
  }

  int right_ = -1;
  Vec3 from_;
};

TEST_F(SmoothingTest, AtRest_ShowsTheSolution) {
  PoseState smooth = MakeState(), plain = MakeState();
  Drag(60, 0.05, &smooth);
  Drag(60, 0, &plain);
  PoseOptions options = Settled();
  options.smoothing = 0.05;
  options.time_step = 1.0 / 60;
  PoseReport report;
  ASSERT_TRUE(smooth.Solve(options, &report).ok());
  report.at_rest = false;
  for (int frame = 0; frame < 300 && !report.at_rest; ++frame)
    ASSERT_TRUE(smooth.Solve(options, &report).ok());
  ASSERT_TRUE(report.at_rest);
  // The plain one, for as many calls: what it shows is its solution.
  ASSERT_TRUE(plain.Solve(Settled(), nullptr).ok());
  const std::span<const float> a = smooth.transforms().matrices, b = plain.transforms().matrices;
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(double{a[i]} - double{b[i]}));
  EXPECT_LT(largest, 1e-6);
  options.smoothing = 0;  // switched off at rest: nothing happens
  const Vector<float> shown(a.begin(), a.end());
  options.iterations = 1;
  ASSERT_TRUE(smooth.Solve(options, nullptr).ok());
  for (size_t i = 0; i < shown.size(); ++i)
    EXPECT_NEAR(smooth.transforms().matrices[i], shown[i], 1e-6f);
}

// An even drag: what the skin does between frames changes far less suddenly.
TEST_F(SmoothingTest, EvenDrag_HasSmallerSecondDifferences) {
  const auto roughness = [this](double smoothing) {
    PoseState state = MakeState();
    PoseOptions options = Settled();
    options.smoothing = smoothing;
    options.time_step = 1.0 / 120;
    Vector<Vector<Vector3d>> shown;
    double largest = 0;
    for (int frame = 1; frame <= 160; ++frame) {
      EXPECT_TRUE(state.SetTarget(right_, Target(frame / 120.0)).ok());
      EXPECT_TRUE(state.Solve(options, nullptr).ok());
      shown.push_back(test::SkinNaively(*rig_, state.transforms()));
      if (shown.size() < 3) continue;
      for (size_t v = 0; v < shown.back().size(); ++v) {
        const size_t f = shown.size() - 1;
        // Across the drag: what the held handle itself does, a stop at the end, is not the skin's.
        const double second = shown[f][v].y() - 2 * shown[f - 1][v].y() + shown[f - 2][v].y();
        largest = std::max(largest, std::abs(second));
      }
    }
    return largest;
  };
  const double rough = roughness(0), smooth = roughness(0.05);
  EXPECT_GT(rough, 0);
  EXPECT_LT(smooth, 0.2 * rough);
}

TEST_F(SmoothingTest, FrameRates_ShowTheSameMotion) {
  PoseState state = MakeState();
  const Vector<double> fine = Drag(480, 0.1, &state);
  double last = 1;
  for (const double rate : {30.0, 60.0, 120.0, 240.0}) {
    PoseState other = MakeState();
    const Vector<double> shown = Drag(rate, 0.1, &other);
    ASSERT_EQ(shown.size(), fine.size());
    double error = 0;
    for (size_t i = 0; i < fine.size(); ++i)
      error = std::max(error, std::abs(shown[i] - fine[i]));
    EXPECT_LT(error, 1.2 / rate) << rate;  // the solution jumps: first order
    EXPECT_LT(error, last) << rate;
    last = error;
  }
}

TEST_F(SmoothingTest, Frames_AllocateNothing) {
  PoseState state = MakeState();
  PoseOptions options;
  options.smoothing = 0.1;
  options.time_step = 0.01;
  options.stretch_limit = 1.1;
  const int64_t before = test::AllocationCount();
  for (int frame = 0; frame < 20; ++frame) {
    (void)state.SetTarget(right_, Target(0.1 * frame));
    (void)state.Solve(options, nullptr);
  }
  EXPECT_EQ(test::AllocationCount(), before);
}

class StretchTest : public PoseOptionsTest {
 protected:
  void SetUp() override {
    Make(test::MakeBendCylinder(12, 16));
    top_ = rig_->FindHandle("top");
    bottom_ = rig_->FindHandle("bottom");
    const auto handles = static_cast<size_t>(rig_->num_handles());
    reach_ = double{rig_->tables().space.scale} *
             double{rig_->tables().handle_reach[static_cast<size_t>(top_) * handles +
                                                static_cast<size_t>(bottom_)]};
  }

  int top_ = -1, bottom_ = -1;
  double reach_ = 0;  // mesh units
};

TEST_F(StretchTest, TargetOutOfReach_StopsAtTheLimit) {
  ASSERT_GT(reach_, 1.9);
  PoseState state = MakeState();
  const Vec3 foot = state.target(bottom_);
  PoseOptions options = Settled();
  options.stretch_limit = 1.2;
  ASSERT_TRUE(state.SetTarget(top_, {0, 9, 0}).ok());
  ASSERT_TRUE(state.SetWeight(bottom_, std::numeric_limits<float>::infinity()).ok());
  PoseReport report;
  ASSERT_TRUE(state.Solve(options, &report).ok());
  EXPECT_EQ(report.pairs_at_limit, 1);
  EXPECT_EQ(report.excess_stretch, 0);
  EXPECT_LT(Distance(Place(state, bottom_), foot), 1e-5);
  EXPECT_NEAR(Distance(Place(state, top_), foot), 1.2 * reach_, 1e-4);
  EXPECT_EQ(state.target(top_), (Vec3{0, 9, 0})) << "what was asked for is kept";
  // Even weights: both give way.
  ASSERT_TRUE(state.SetWeight(bottom_, 1).ok());
  ASSERT_TRUE(state.Solve(options, &report).ok());
  EXPECT_GT(Distance(Place(state, bottom_), foot), 1);
  EXPECT_NEAR(Distance(Place(state, top_), Place(state, bottom_)), 1.2 * reach_, 1e-4);
  // No limit: all the way.
  options.stretch_limit = 0;
  ASSERT_TRUE(state.Solve(options, &report).ok());
  EXPECT_EQ(report.pairs_at_limit, 0);
  EXPECT_LT(Distance(Place(state, top_), {0, 9, 0}), 1e-3);
}

TEST_F(StretchTest, TargetsWithinReach_AreUntouched) {
  PoseState limited = MakeState(), free = MakeState();
  PoseOptions options = Settled();
  for (PoseState* state : {&limited, &free}) {
    ASSERT_TRUE(state->SetTarget(top_, {0.4f, 1.6f, 0.2f}).ok());
    ASSERT_TRUE(state->Solve(options, nullptr).ok());
    options.stretch_limit = 1.0;
  }
  for (size_t i = 0; i < free.transforms().matrices.size(); ++i)
    EXPECT_EQ(limited.transforms().matrices[i], free.transforms().matrices[i]);
}

TEST_F(StretchTest, WhatCannotBeLimited_IsRefused) {
  PoseState state = MakeState();
  EXPECT_EQ(state.SetWeight(top_, 0).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetWeight(99, 1).code(), StatusCode::kInvalidArgument);
  PoseOptions options;
  options.stretch_limit = -1;
  EXPECT_EQ(state.Solve(options, nullptr).code(), StatusCode::kInvalidArgument);
  bake::RawCharacter raw = test::MakeBendCylinder(12, 16);
  Result<bake::BakedCharacter> baked = bake::Bake(raw, raw.marked_handles, {}, {});
  ASSERT_TRUE(baked.ok());
  baked->tables.handle_reach.clear();
  PoseState old = PoseState::Create(
                      Rig::Create("old", std::move(baked->tables), std::move(baked->mesh)).value())
                      .value();
  options.stretch_limit = 1.2;
  EXPECT_EQ(old.Solve(options, nullptr).code(), StatusCode::kUnsupported);
}

class GuaranteedTest : public PoseOptionsTest {
 protected:
  void SetUp() override {
    Make(test::MakeBendCylinder(12, 16));
    top_ = rig_->FindHandle("top");
  }

  int top_ = -1;
};

// Whatever is held; a grab in the middle of it begins anew and goes on as well.
TEST_F(GuaranteedTest, EnergyNeverIncreases_AndComesToRest) {
  PoseState state = MakeState({4, 4, true});
  PoseOptions options;
  options.guaranteed = true;
  for (const Vec3 target : {Vec3{0.9f, 1.2f, 0.3f}, {-1, 0.5f, 0}, {0.2f, 3, 0.1f}}) {
    ASSERT_TRUE(state.SetTarget(top_, target).ok());
    ASSERT_TRUE(state.Grab({{40, 40, 40}, {1, 0, 0}}).ok());
    PoseReport report;
    double last = std::numeric_limits<double>::infinity();
    for (int frame = 0; frame < 3000 && !report.settled; ++frame) {
      ASSERT_TRUE(state.Solve(options, &report).ok());
      if (frame > 120) {  // D has come to rest by then
        ASSERT_LE(report.energy, last * (1 + 1e-9)) << frame;
      }
      last = report.energy;
    }
    EXPECT_TRUE(report.settled);
    EXPECT_LT(Distance(Place(state, top_), target), 1e-4);
  }
}

// From the guaranteed mode's rest the plain alternation finds nothing much lower, and the other
// way.
TEST_F(GuaranteedTest, SwitchedOnAndOff_GoesOnFromWhereItWas) {
  PoseState state = MakeState({0, 0, true});
  ASSERT_TRUE(state.SetTarget(top_, {0.6f, 1.7f, 0.1f}).ok());
  PoseOptions plain = Settled(), guaranteed = Settled();
  guaranteed.guaranteed = true;
  PoseReport first, second, third;
  ASSERT_TRUE(state.Solve(plain, &first).ok());
  ASSERT_TRUE(state.Solve(guaranteed, &second).ok());
  ASSERT_TRUE(state.Solve(plain, &third).ok());
  EXPECT_NEAR(second.energy, first.energy, 2e-3 * first.energy);
  EXPECT_NEAR(third.energy, first.energy, 2e-3 * first.energy);
}

TEST_F(GuaranteedTest, WhereItCannotBe_IsRefused) {
  PoseOptions options;
  options.guaranteed = true;
  PoseState without = MakeState();
  EXPECT_EQ(without.Solve(options, nullptr).code(), StatusCode::kInvalidArgument);
  PoseState state = MakeState({1, 1, true});
  EXPECT_TRUE(state.Solve(options, nullptr).ok());
  options.smoothing = 0.1;
  EXPECT_EQ(state.Solve(options, nullptr).code(), StatusCode::kUnsupported);
  options.smoothing = 0;
  ASSERT_TRUE(state.SetStiffness(top_, 3).ok());
  EXPECT_EQ(state.Solve(options, nullptr).code(), StatusCode::kUnsupported);
  ASSERT_TRUE(state.SetStiffness(top_, kHeldExactly).ok());
  ASSERT_TRUE(state.SetRotation(top_, {}).ok());
  EXPECT_EQ(state.Solve(options, nullptr).code(), StatusCode::kUnsupported);
}

}  // namespace
}  // namespace limber
