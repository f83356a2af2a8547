// The alternation's convex step on posed characters against Ipopt on the transforms and the blend
// weights both: the reduction and the active set against the problem as the paper states it.
#include "runtime/convex_oracle/full_problem.h"
#include "runtime/convex_oracle/ipopt_solver.h"
#include "runtime/solve/solved_character.h"

#include <optional>
#include <random>

namespace limber::oracle {
namespace {

struct Mode {
  bool rotations = true, square_roots = true;
};

// A character in memory that comes to poses no example has.
template <int K>
struct Posed {
  Posed(const bake::RawCharacter& raw, const Mode& mode) {
    bake::BakeOptions options;
    options.num_groups = 5;
    options.rotations = mode.rotations;
    rig = test::BakeInMemory(raw, options);
    if (rig == nullptr) return;
    model = PoseModel::Create(rig).value();
    settings.rotations = mode.rotations;
    settings.square_roots = mode.square_roots;
    alternation.emplace(*model);
  }

  // From rest towards the next random targets.
  void Pose(int alternations = 8) {
    std::uniform_real_distribution<double> sway(-0.3, 0.3);
    for (size_t c = 0; c < model->pins->size(); ++c) {
      const RigHandle& handle = rig->tables().handles[size_t(model->pinned_handles[c])];
      const Vec3 x = rig->ToRig(handle.rest_position);
      for (int axis = 0; axis < K; ++axis)
        alternation->targets[c * K + size_t(axis)] = x[axis] + sway(numbers);
    }
    alternation->ResetToRest(*model);
    for (int i = 0; i < alternations; ++i)
      alternation->Run(*model, settings);
  }

  std::shared_ptr<const Rig> rig;
  std::shared_ptr<const PoseModel> model;
  typename Alternation<K>::Settings settings;
  std::optional<Alternation<K>> alternation;
  std::mt19937 numbers{7};
};

template <int K>
void CompareWithIpopt(const bake::RawCharacter& raw, const Mode& mode) {
  Posed<K> posed(raw, mode);
  ASSERT_TRUE(posed.alternation.has_value());
  const PoseModel& model = *posed.model;
  const FullProblem<K> full(model, TransformUnknowns::kTransforms);
  IpoptSolver ipopt(IpoptSolver::Form::kQuotient, 1e-10);
  for (int pose = 0; pose < 6; ++pose) {
    posed.Pose();
    const ConvexProblem problem = full.Make(&*posed.alternation, posed.settings);
    const Eigen::VectorXd ours = full.Unknowns(&*posed.alternation);
    const double reached = ReachedObjective<K>(model, posed.settings, &*posed.alternation);
    // The reduced energy is the full problem's, at transforms of single precision.
    EXPECT_NEAR(problem.Objective(ours), reached, 1e-5 * reached) << pose;
    EXPECT_LT((problem.equality * ours - problem.right).cwiseAbs().maxCoeff(), 1e-5) << pose;
    Eigen::VectorXd start = Eigen::VectorXd::Zero(ours.size());
    start.tail(model.num_blocks).setConstant(1.0 / model.num_shapes);
    const IpoptAnswer answer = ipopt.Solve(problem, start, false);
    ASSERT_TRUE(answer.converged) << pose;
    EXPECT_LE(reached, answer.objective * (1 + 1e-6)) << pose;
    EXPECT_LE(answer.objective, reached * (1 + 1e-6)) << pose;
    // A worse answer would be seen: the same transforms with the same weights on all shapes.
    Eigen::VectorXd worse = ours;
    worse.tail(model.num_blocks) = start.tail(model.num_blocks);
    EXPECT_GT(problem.Objective(worse), reached * (1 + 1e-3)) << pose;
  }
}

// What the benchmark measures is what the alternation did.
TEST(RepeatedConvexStep, GivesTheSameBlendWeights) {
  for (const bool rotations : {true, false}) {
    Posed<3> posed(test::MakeBendCylinder(12, 16), {rotations, true});
    ASSERT_TRUE(posed.alternation.has_value());
    double moved = 0;
    for (int pose = 0; pose < 6; ++pose) {
      posed.Pose(1);
      const AlignedVector<double> blend = posed.alternation->blend();
      for (size_t block = 0; block < size_t(posed.model->num_blocks);
           block += size_t(posed.model->num_shapes))
        moved = std::max(moved, std::abs(blend[block] - 1));
      EXPECT_TRUE(posed.alternation->RepeatConvexStep(*posed.model).converged);
      for (size_t i = 0; i < blend.size(); ++i)
        EXPECT_NEAR(posed.alternation->blend()[i], blend[i], 1e-9) << i;
    }
    EXPECT_GT(moved, 0.1) << "the step must leave the shape that it starts from";
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
