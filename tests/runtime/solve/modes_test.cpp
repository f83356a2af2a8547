// The paper's variants of the energy: one blend for the whole character, no square roots, extremes
// of lambda.
#include "runtime/solve/solved_character.h"
#include "solve/pose_solver.h"

#include <algorithm>

namespace limber {
namespace {

class ModesTest : public testing::Test {
 protected:
  void SetUp() override {
    rig_ = test::BakeInMemory(test::MakeBendCylinder(12, 16));
    ASSERT_NE(rig_, nullptr);
    top_ = rig_->FindHandle("top");
  }

  // Solved to rest with the top handle there.
  PoseReport SolveAt(Vec3 top, PoseOptions options, PoseState* state) const {
    options.iterations = 3000;
    options.settle_tolerance = 1e-10;
    PoseReport report;
    EXPECT_TRUE(state->SetTarget(top_, top).ok());
    EXPECT_TRUE(state->Solve(options, &report).ok());
    return report;
  }

  double Weight(const PoseState& state, int group, int shape) const {
    return state.blend_weights()[static_cast<size_t>(group * rig_->num_shapes() + shape)];
  }

  std::shared_ptr<const Rig> rig_;
  int top_ = -1;
  const Vec3 between_ = {0.5f, 1.6f, 0.1f};
};

TEST_F(ModesTest, UniformBlend_IsTheSameInAllGroupsAndCostsMore) {
  PoseOptions varying, uniform;
  varying.rotations = uniform.rotations = false;  // convex: both are global optima
  uniform.varying_blend = false;
  PoseState free = PoseState::Create(rig_).value(), bound = PoseState::Create(rig_).value();
  const PoseReport least = SolveAt(between_, varying, &free);
  const PoseReport more = SolveAt(between_, uniform, &bound);
  for (int g = 1; g < rig_->num_groups(); ++g) {
    for (int s = 0; s < rig_->num_shapes(); ++s)
      EXPECT_EQ(Weight(bound, g, s), Weight(bound, 0, s));
  }
  EXPECT_TRUE(more.optimal);
  EXPECT_GE(more.energy, least.energy * (1 - 1e-9));
  EXPECT_GT(more.energy, least.energy * (1 + 1e-6)) << "the pose must be one where it matters";
}

// No blend on a line between uniform ones does better: the convex step of one group is optimal.
TEST_F(ModesTest, UniformBlend_SwitchedToAndFrom_IsTheSame) {
  PoseOptions varying, uniform;
  varying.rotations = uniform.rotations = false;
  uniform.varying_blend = false;
  PoseState direct = PoseState::Create(rig_).value(), switched = PoseState::Create(rig_).value();
  const PoseReport expected = SolveAt(between_, uniform, &direct);
  SolveAt({-0.4f, 1.4f, 0.3f}, varying, &switched);
  const PoseReport report = SolveAt(between_, uniform, &switched);
  EXPECT_NEAR(report.energy, expected.energy, 1e-6 * expected.energy);
}

TEST_F(ModesTest, AllModes_GiveAnExampleBackFromItsOwnHandles) {
  for (const bool roots : {true, false}) {
    for (const bool varying : {true, false}) {
      for (const bool rotations : {true, false}) {
        PoseOptions options;
        options.square_roots = roots;
        options.varying_blend = varying;
        options.rotations = rotations;
        PoseState state = PoseState::Create(rig_).value();
        for (int h = 0; h < rig_->num_handles(); ++h) {
          const RigHandle& handle = rig_->tables().handles[static_cast<size_t>(h)];
          const Eigen::Vector3d p = test::ShapePosition(*rig_, 1, handle.vertex);
          if (!handle.pinned) continue;
          ASSERT_TRUE(state
                          .SetTarget(h, {static_cast<float>(p.x()), static_cast<float>(p.y()),
                                         static_cast<float>(p.z())})
                          .ok());
        }
        options.iterations = 3000;
        options.settle_tolerance = 1e-10;
        PoseReport report;
        ASSERT_TRUE(state.Solve(options, &report).ok());
        for (int g = 0; g < rig_->num_groups(); ++g)
          EXPECT_GT(Weight(state, g, 1), 0.99) << roots << varying << rotations << " group " << g;
      }
    }
  }
}

TEST_F(ModesTest, LargeLambda_PicksOneShapeAGroup) {
  PoseOptions options;
  options.lambda = 1e4f;
  options.rotations = false;
  PoseState state = PoseState::Create(rig_).value();
  SolveAt(between_, options, &state);
  for (int g = 0; g < rig_->num_groups(); ++g) {
    double largest = 0;
    for (int s = 0; s < rig_->num_shapes(); ++s)
      largest = std::max(largest, Weight(state, g, s));
    EXPECT_GT(largest, 0.999) << g;
  }
}

// Shape space only: the elastic energy is the least that any blend has.
TEST_F(ModesTest, ZeroLambda_HasTheLeastElasticEnergy) {
  PoseOptions options;
  options.rotations = false;
  PoseState state = PoseState::Create(rig_).value();
  const double with = SolveAt(between_, options, &state).elastic;
  options.lambda = 0;
  const PoseReport report = SolveAt(between_, options, &state);
  EXPECT_LT(report.elastic, with);
  EXPECT_EQ(report.energy, report.elastic);
}

}  // namespace
}  // namespace limber
