#include "core/vector.h"
#include "runtime/solve/solved_character.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"
#include "support/counting_allocator.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <limits>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace limber {
namespace {

class PoseStateTest : public testing::Test {
 protected:
  void SetUp() override {
    rig_ = test::BakeInMemory(test::MakeBendCylinder(12, 16));
    ASSERT_NE(rig_, nullptr);
    model_ = PoseModel::Create(rig_).value();
    top_ = rig_->FindHandle("top");
  }

  PoseState MakeState() const {
    Result<PoseState> state = PoseState::Create(model_);
    EXPECT_TRUE(state.ok()) << state.status().message();
    return std::move(state).value();
  }

  // A scripted wobble of the top handle; frame numbers from 0.
  void SolveFrame(int frame, PoseState* state) const {
    const float t = 0.1f * static_cast<float>(frame);
    ASSERT_TRUE(
        state->SetTarget(top_, {0.8f * std::sin(t), 1.6f + 0.3f * std::cos(2 * t), 0.2f}).ok());
    ASSERT_TRUE(state->Solve({}, nullptr).ok());
  }

  std::shared_ptr<const Rig> rig_;
  std::shared_ptr<const PoseModel> model_;
  int top_ = -1;
};

TEST_F(PoseStateTest, SetTarget_RefusesNonsenseAndKeepsTheOldTarget) {
  PoseState state = MakeState();
  const Vec3 before = state.target(top_);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(state.SetTarget(-1, {}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetTarget(99, {}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetTarget(top_, {0, nan, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetTarget(rig_->FindHandle("middle"), {}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.SetTarget(top_, {1e30f, 0, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(state.target(top_), before);
  EXPECT_EQ(state.target(-1), Vec3{});
}

TEST_F(PoseStateTest, Create_WithoutARigOrModel_SaysSo) {
  EXPECT_EQ(PoseState::Create(std::shared_ptr<const Rig>()).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(PoseState::Create(std::shared_ptr<const PoseModel>()).status().code(),
            StatusCode::kInvalidArgument);
}

TEST_F(PoseStateTest, FarTargets_StayFiniteAndComeBack) {
  PoseState state = MakeState();
  const Vec3 rest = state.target(top_);
  for (float far : {1e2f, 1e5f, -1e5f}) {
    ASSERT_TRUE(state.SetTarget(top_, {far, 0, far}).ok());
    for (int frame = 0; frame < 5; ++frame)
      ASSERT_TRUE(state.Solve({}, nullptr).ok());
    for (float value : state.transforms().matrices)
      ASSERT_TRUE(std::isfinite(value));
  }
  ASSERT_TRUE(state.SetTarget(top_, rest).ok());
  for (int frame = 0; frame < 30; ++frame)
    ASSERT_TRUE(state.Solve({}, nullptr).ok());
  // Held at two points of its axis the cylinder may have turned about it: what must be back is the
  // height of every vertex along the axis, and its distance from it.
  const auto q = test::SkinNaively(*rig_, state.transforms());
  for (uint32_t v = 0; v < q.size(); ++v) {
    const Eigen::Vector3d p = test::ShapePosition(*rig_, 0, v);
    EXPECT_NEAR(q[v].y(), p.y(), 0.05 * rig_->diagonal());
    EXPECT_NEAR(std::hypot(q[v].x(), q[v].z()), std::hypot(p.x(), p.z()), 0.05 * rig_->diagonal());
  }
}

TEST_F(PoseStateTest, ToleranceZero_RunsAllIterations) {
  PoseState state = MakeState();
  PoseOptions options;
  options.iterations = 7;
  PoseReport report;
  ASSERT_TRUE(state.Solve(options, &report).ok());
  EXPECT_EQ(report.iterations, 7);
  EXPECT_FALSE(report.settled);
}

// Against what the allocator handed out.
TEST_F(PoseStateTest, ModelBytes_AreWhatItHolds) {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
  const auto held = [] {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };
  bake::BakeOptions options;
  options.num_groups = 64;  // large, beside what an allocation costs on top
  rig_ = test::BakeInMemory(test::MakeBendCylinder(24, 24), options);
  ASSERT_NE(rig_, nullptr);
  const double before = held();
  const auto model = PoseModel::Create(rig_).value();
  EXPECT_NEAR(static_cast<double>(model->bytes()), held() - before, 0.02 * (held() - before));
#else
  GTEST_SKIP() << "this build's allocator does not say what it handed out";
#endif
}

// Bits are the same, every stage was seen, and the sum is no more than the call took. Off, nothing
// is filled in.
TEST_F(PoseStateTest, MeasureStages_FillsThemAndChangesNothing) {
  PoseState plain = MakeState(), measured = MakeState();
  PoseOptions options, measuring;
  options.iterations = measuring.iterations = 50;
  measuring.measure_stages = true;
  PoseReport off, on;
  ASSERT_TRUE(plain.SetTarget(top_, {0.5f, 1.6f, 0.1f}).ok());
  ASSERT_TRUE(measured.SetTarget(top_, {0.5f, 1.6f, 0.1f}).ok());
  ASSERT_TRUE(plain.Solve(options, &off).ok());
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(measured.Solve(measuring, &on).ok());
  const double whole =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_TRUE(std::ranges::equal(plain.transforms().matrices, measured.transforms().matrices));
  EXPECT_EQ(on.energy, off.energy);
  for (double StageTimes::*stage : {&StageTimes::rotations, &StageTimes::nearness,
                                    &StageTimes::blend, &StageTimes::transforms}) {
    EXPECT_GT(on.stages.*stage, 0);
    EXPECT_EQ(off.stages.*stage, 0);
  }
  EXPECT_LE(on.stages.rotations + on.stages.nearness + on.stages.blend + on.stages.transforms,
            whole);
}

TEST_F(PoseStateTest, TimeBudget_EndsTheCallAndSaysSo) {
  PoseState state = MakeState();
  PoseOptions options;
  options.iterations = 1'000'000;
  options.time_budget = 1e-3;
  PoseReport report;
  ASSERT_TRUE(state.Solve(options, &report).ok());
  EXPECT_TRUE(report.out_of_time);
  EXPECT_FALSE(report.settled);
  EXPECT_GE(report.iterations, 1);
  EXPECT_LT(report.iterations, options.iterations);
  options.iterations = 3;
  options.time_budget = 3600;
  ASSERT_TRUE(state.Solve(options, &report).ok());
  EXPECT_FALSE(report.out_of_time);
  EXPECT_EQ(report.iterations, 3);
  options.time_budget = -1;
  EXPECT_EQ(state.Solve(options, nullptr).code(), StatusCode::kInvalidArgument);
}

TEST_F(PoseStateTest, Solve_RefusesOptionsOutOfRange) {
  PoseState state = MakeState();
  PoseOptions options;
  options.iterations = 0;
  EXPECT_EQ(state.Solve(options, nullptr).code(), StatusCode::kInvalidArgument);
  options = {};
  options.lambda = -1;
  EXPECT_EQ(state.Solve(options, nullptr).code(), StatusCode::kInvalidArgument);
}

TEST_F(PoseStateTest, RigWithoutRotations_RefusesThemAndSolvesWithout) {
  bake::BakeOptions options;
  options.rotations = false;
  std::shared_ptr<const Rig> rig = test::BakeInMemory(test::MakeBendCylinder(12, 16), options);
  ASSERT_NE(rig, nullptr);
  PoseState folded = PoseState::Create(rig).value();
  EXPECT_EQ(folded.Solve({}, nullptr).code(), StatusCode::kUnsupported);
  // The folded tables and the full ones, held at the identity, are the same problem.
  PoseState full = MakeState();
  PoseOptions plain;
  plain.rotations = false;
  plain.iterations = 3;
  PoseReport folded_report, full_report;
  for (PoseState* state : {&folded, &full}) {
    ASSERT_TRUE(state->SetTarget(top_, {0.4f, 1.7f, 0.1f}).ok());
  }
  ASSERT_TRUE(folded.Solve(plain, &folded_report).ok());
  ASSERT_TRUE(full.Solve(plain, &full_report).ok());
  EXPECT_NEAR(folded_report.energy, full_report.energy, 1e-5 * full_report.energy);
}

TEST_F(PoseStateTest, AtRest_TheFirstShapeIsThere) {
  const PoseState state = MakeState();
  const Vector<Eigen::Vector3d> q = test::SkinNaively(*rig_, state.transforms());
  for (uint32_t v = 0; v < q.size(); ++v) {
    EXPECT_LT((q[v] - test::ShapePosition(*rig_, 0, v)).norm(), 1e-5 * rig_->diagonal());
  }
}

TEST_F(PoseStateTest, RigidMotionOfAllTargets_MovesTheResultRigidly) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(3, -1, 2);
  const int bottom = rig_->FindHandle("bottom");
  const Eigen::Vector3d targets[] = {{0.1, 0.05, 0}, {0.6, 1.5, 0.2}};
  PoseOptions settle;
  settle.iterations = 4000;
  settle.settle_tolerance = 1e-11;
  PoseState plain = MakeState(), moved = MakeState();
  const auto set = [](PoseState* state, int handle, const Eigen::Vector3d& p) {
    ASSERT_TRUE(state
                    ->SetTarget(handle, {static_cast<float>(p.x()), static_cast<float>(p.y()),
                                         static_cast<float>(p.z())})
                    .ok());
  };
  set(&plain, bottom, targets[0]);
  set(&plain, top_, targets[1]);
  set(&moved, bottom, turn * targets[0] + shift);
  set(&moved, top_, turn * targets[1] + shift);
  PoseReport plain_report, moved_report;
  ASSERT_TRUE(plain.Solve(settle, &plain_report).ok());
  ASSERT_TRUE(moved.Solve(settle, &moved_report).ok());
  EXPECT_NEAR(plain_report.energy, moved_report.energy, 1e-4 * plain_report.energy);
  // A cylinder held at two points may turn about their axis for free, so what is compared is what
  // the targets determine: every vertex's distance from both handles.
  const auto p = test::SkinNaively(*rig_, plain.transforms());
  const auto q = test::SkinNaively(*rig_, moved.transforms());
  for (size_t v = 0; v < p.size(); v += 7) {
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR((p[v] - targets[i]).norm(), (q[v] - (turn * targets[i] + shift)).norm(),
                  2e-2 * rig_->diagonal());
    }
  }
}

TEST_F(PoseStateTest, Translation_OfAllTargetsMovesTheResultByIt) {
  PoseState plain = MakeState(), moved = MakeState();
  const Vec3 shift = {5, -7, 11};
  for (int frame = 0; frame < 10; ++frame) {
    for (const char* name : {"bottom", "top"}) {
      const int handle = rig_->FindHandle(name);
      Vec3 target = plain.target(handle);
      if (handle == top_) target.x += 0.05f;
      ASSERT_TRUE(plain.SetTarget(handle, target).ok());
      ASSERT_TRUE(
          moved.SetTarget(handle, {target.x + shift.x, target.y + shift.y, target.z + shift.z})
              .ok());
    }
    ASSERT_TRUE(plain.Solve({}, nullptr).ok());
    ASSERT_TRUE(moved.Solve({}, nullptr).ok());
  }
  const auto p = test::SkinNaively(*rig_, plain.transforms());
  const auto q = test::SkinNaively(*rig_, moved.transforms());
  for (size_t v = 0; v < p.size(); ++v) {
    EXPECT_LT((q[v] - p[v] - Eigen::Vector3d(shift.x, shift.y, shift.z)).norm(), 1e-4);
  }
}

TEST_F(PoseStateTest, ExamplesComeBackFromTheirOwnHandles) {
  PoseState state = MakeState();
  for (int s : {1, 2, 0}) {
    PoseReport report;
    for (int step = 1; step <= 20; ++step) {
      for (int h = 0; h < rig_->num_handles(); ++h) {
        const RigHandle& handle = rig_->tables().handles[static_cast<size_t>(h)];
        if (!handle.pinned) continue;
        const Eigen::Vector3d goal = test::ShapePosition(*rig_, s, handle.vertex);
        const Vec3 now = state.target(h);
        const float f = 1.0f / static_cast<float>(21 - step);
        ASSERT_TRUE(state
                        .SetTarget(h, {now.x + f * (static_cast<float>(goal.x()) - now.x),
                                       now.y + f * (static_cast<float>(goal.y()) - now.y),
                                       now.z + f * (static_cast<float>(goal.z()) - now.z)})
                        .ok());
      }
      ASSERT_TRUE(state.Solve({}, &report).ok());
    }
    PoseOptions settle;
    settle.iterations = 500;
    settle.settle_tolerance = 1e-9;
    ASSERT_TRUE(state.Solve(settle, &report).ok());
    for (int g = 0; g < rig_->num_groups(); ++g) {
      EXPECT_GT(state.blend_weights()[static_cast<size_t>(g * 3 + s)], 0.99) << "shape " << s;
    }
  }
}

TEST_F(PoseStateTest, SteadyFrames_AllocateNothing) {
  PoseState state = MakeState();
  for (int frame = 0; frame < 5; ++frame)
    SolveFrame(frame, &state);
  PoseReport report;
  const int64_t before = test::AllocationCount();
  for (int frame = 5; frame < 60; ++frame) {
    const float t = 0.1f * static_cast<float>(frame);
    (void)state.SetTarget(top_, {std::sin(t), 1.5f, 0});
    (void)state.Solve({}, &report);
    (void)state.transforms();
  }
  EXPECT_EQ(test::AllocationCount() - before, 0);
}

TEST_F(PoseStateTest, SameInput_SameBits) {
  PoseState a = MakeState(), b = MakeState();
  for (int frame = 0; frame < 40; ++frame) {
    SolveFrame(frame, &a);
    SolveFrame(frame, &b);
    const auto one = a.transforms().matrices, other = b.transforms().matrices;
    ASSERT_TRUE(std::equal(one.begin(), one.end(), other.begin())) << "frame " << frame;
  }
}

TEST_F(PoseStateTest, ResetToRest_ForgetsEverything) {
  PoseState fresh = MakeState(), used = MakeState();
  for (int frame = 0; frame < 20; ++frame)
    SolveFrame(frame, &used);
  used.ResetToRest();
  const auto one = fresh.transforms().matrices, other = used.transforms().matrices;
  EXPECT_TRUE(std::equal(one.begin(), one.end(), other.begin()));
}

TEST_F(PoseStateTest, TargetsThatRest_TheCharacterComesToRest) {
  PoseState state = MakeState();
  for (int frame = 0; frame < 20; ++frame)
    SolveFrame(frame, &state);
  PoseOptions settle;
  settle.iterations = 5000;
  settle.settle_tolerance = 1e-8;
  PoseReport report;
  ASSERT_TRUE(state.Solve(settle, &report).ok());
  EXPECT_TRUE(report.settled) << report.change;
  const auto before = test::SkinNaively(*rig_, state.transforms());
  ASSERT_TRUE(state.Solve({}, nullptr).ok());
  const auto after = test::SkinNaively(*rig_, state.transforms());
  for (size_t v = 0; v < after.size(); ++v) {
    EXPECT_LT((after[v] - before[v]).norm(), 1e-5 * rig_->diagonal());
  }
}

}  // namespace
}  // namespace limber
