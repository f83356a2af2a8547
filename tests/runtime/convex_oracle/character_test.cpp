// The alternation's convex step on posed characters against Ipopt on the transforms and the blend
// weights both: the reduction and the active set against the problem as the paper states it.
#include "runtime/convex_oracle/full_problem.h"
#include "runtime/convex_oracle/ipopt_solver.h"
#include "runtime/solve/solved_character.h"

#include <random>

namespace limber::oracle {
namespace {

struct Mode {
  bool rotations = true, square_roots = true;
};

template <int K>
void CompareWithIpopt(const bake::RawCharacter& raw, const Mode& mode) {
  bake::BakeOptions options;
  options.num_groups = 5;
  options.rotations = mode.rotations;
  const std::shared_ptr<const Rig> rig = test::BakeInMemory(raw, options);
  ASSERT_NE(rig, nullptr);
  const std::shared_ptr<const PoseModel> model = PoseModel::Create(rig).value();
  ASSERT_EQ(model->k, K);
  typename Alternation<K>::Settings settings;
  settings.rotations = mode.rotations;
  settings.square_roots = mode.square_roots;
  const FullProblem<K> full(*model);
  IpoptSolver ipopt(IpoptSolver::Form::kQuotient, 1e-10);
  std::mt19937 numbers(7);
  std::uniform_real_distribution<double> sway(-0.3, 0.3);
  for (int pose = 0; pose < 6; ++pose) {
    Alternation<K> alternation(*model);
    for (size_t c = 0; c < model->pins->size(); ++c) {
      const RigHandle& handle = rig->tables().handles[size_t(model->pins->handles[c])];
      const Vec3 x = rig->ToRig(handle.rest_position);
      for (int axis = 0; axis < K; ++axis)
        alternation.targets[c * K + size_t(axis)] = x[axis] + sway(numbers);
    }
    alternation.ResetToRest(*model);
    for (int i = 0; i < 8; ++i)
      alternation.Run(*model, settings);
    const ConvexProblem problem = full.Make(&alternation, settings);
    const Eigen::VectorXd ours = full.Unknowns(&alternation);
    const double reached = ReachedObjective<K>(*model, settings, &alternation);
    // The reduced energy is the full problem's, at transforms of single precision.
    EXPECT_NEAR(problem.Objective(ours), reached, 1e-5 * reached) << pose;
    EXPECT_LT((problem.equality * ours - problem.right).cwiseAbs().maxCoeff(), 1e-5) << pose;
    Eigen::VectorXd start = Eigen::VectorXd::Zero(ours.size());
    start.tail(model->num_blocks).setConstant(1.0 / model->num_shapes);
    const IpoptAnswer answer = ipopt.Solve(problem, start, false);
    ASSERT_TRUE(answer.converged) << pose;
    EXPECT_LE(reached, answer.objective * (1 + 1e-6)) << pose;
    EXPECT_LE(answer.objective, reached * (1 + 1e-6)) << pose;
    // A worse answer would be seen: the same transforms with the same weights on all shapes.
    Eigen::VectorXd worse = ours;
    worse.tail(model->num_blocks) = start.tail(model->num_blocks);
    EXPECT_GT(problem.Objective(worse), reached * (1 + 1e-3)) << pose;
  }
}

class CharacterAgainstIpopt : public testing::TestWithParam<Mode> {
 protected:
  void SetUp() override {
    if (!IpoptSolver::IsAvailable()) GTEST_SKIP() << "built without Ipopt (coinor-libipopt-dev)";
  }
};

TEST_P(CharacterAgainstIpopt, Square_IsNoWorse) {
  CompareWithIpopt<2>(test::MakeStretchSquare(8), GetParam());
}

TEST_P(CharacterAgainstIpopt, Cylinder_IsNoWorse) {
  CompareWithIpopt<3>(test::MakeBendCylinder(12, 16), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Modes, CharacterAgainstIpopt,
                         testing::Values(Mode{true, true}, Mode{true, false}, Mode{false, true},
                                         Mode{false, false}),
                         [](const auto& test) {
                           return std::string(test.param.rotations ? "Rotations" : "NoRotations") +
                                  (test.param.square_roots ? "SquareRoots" : "NoSquareRoots");
                         });

}  // namespace
}  // namespace limber::oracle
