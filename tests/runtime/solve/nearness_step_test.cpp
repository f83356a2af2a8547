// What is not evaluated must not matter: the lower bounds of sqrt(D) are bounds, and good ones.
#include "solve/nearness_step.h"

#include "core/vector.h"
#include "runtime/solve/solved_character.h"

#include <cmath>
#include <random>

namespace limber {
namespace {

class NearnessStepTest : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    const std::shared_ptr<const Rig> rig = test::BakeInMemory(test::MakeBendCylinder(12, 16));
    ASSERT_NE(rig, nullptr);
    model_ = PoseModel::Create(rig).value();
    for (const int handle : model_->pinned_handles) {
      const Vec3 x = rig->ToRig(rig->tables().handles[static_cast<size_t>(handle)].rest_position);
      rest_.insert(rest_.end(), {double{x.x}, double{x.y}, double{x.z}});
    }
  }

  Vector<double> TargetsAt(int frame) const {
    Vector<double> targets = rest_;
    for (size_t i = 0; i < targets.size(); ++i) {
      const double phase = static_cast<double>(i);
      targets[i] += 0.4 * std::sin(0.02 * frame + phase) - 0.4 * std::sin(phase);
    }
    return targets;
  }

  std::shared_ptr<const PoseModel> model_;
  Vector<double> rest_;  // [c][3], rig space
};

TEST_P(NearnessStepTest, LowerBounds_AreBelowTheRootsAndNear) {
  const bool hold_rotations = GetParam();
  NearnessStep<3> lazy(*model_), thorough(*model_);
  std::mt19937 engine(5);
  double bounds = 0, roots = 0;
  for (int frame = 0; frame < 300; ++frame) {
    const Vector<double> targets = TargetsAt(frame);
    lazy.Run(*model_, *model_->pins, targets.data(), hold_rotations);
    thorough.Run(*model_, *model_->pins, targets.data(), hold_rotations);
    for (int block = 0; block < model_->num_blocks; ++block) {
      const double root = thorough.Root(*model_, block), bound = lazy.LowerBound(block);
      ASSERT_LE(bound, root) << "frame " << frame << " block " << block;
      if (frame >= 50) {
        bounds += bound;
        roots += root;
      }
      // Every frame some are asked for: the same number to the last bit, and no bound any more.
      if (engine() % 8 == 0) {
        ASSERT_EQ(lazy.Root(*model_, block), root);
        ASSERT_EQ(lazy.LowerBound(block), root);
      }
    }
  }
  EXPECT_GT(bounds, 0.5 * roots) << "bounds this loose would save nothing";
}

TEST_P(NearnessStepTest, TargetsAtRest_BoundsStayRoots) {
  NearnessStep<3> step(*model_);
  const Vector<double> targets = TargetsAt(100);
  for (int frame = 0; frame < 3000; ++frame)
    step.Run(*model_, *model_->pins, targets.data(), GetParam());
  Vector<double> roots;
  for (int block = 0; block < model_->num_blocks; ++block)
    roots.push_back(step.Root(*model_, block));
  for (int frame = 0; frame < 100; ++frame)
    step.Run(*model_, *model_->pins, targets.data(), GetParam());
  for (int block = 0; block < model_->num_blocks; ++block) {
    const double root = roots[static_cast<size_t>(block)];
    EXPECT_LE(step.LowerBound(block), root);
    EXPECT_GT(step.LowerBound(block), 0.9 * root) << block;
  }
}

INSTANTIATE_TEST_SUITE_P(Rotations, NearnessStepTest, testing::Bool());

}  // namespace
}  // namespace limber
