// The convex step against its optimality conditions and against an independent, slow solver.
#include "solve/blend_weight_step.h"

#include "core/vector.h"
#include "runtime/solve/dense_form.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

// f(B) = 1/2 |A B - a|^2.
struct RandomProblem {
  int groups, shapes;
  Eigen::MatrixXd a;
  Eigen::VectorXd target, nearness, start;
  bool square_root = true;

  double F(const Eigen::VectorXd& b) const { return 0.5 * (a * b - target).squaredNorm(); }

  double Objective(const Eigen::VectorXd& b) const {
    return (square_root ? std::sqrt(F(b)) : F(b)) + nearness.dot(b);
  }

  Eigen::VectorXd Slope(const Eigen::VectorXd& b) const {
    const double outer = square_root ? 0.5 / std::max(std::sqrt(F(b)), 1e-12) : 1;
    return outer * a.transpose() * (a * b - target) + nearness;
  }
};

RandomProblem Make(int groups, int shapes, int rows, unsigned seed) {
  srand(seed);
  RandomProblem p{groups, shapes, {}, {}, {}, {}};
  const int n = groups * shapes;
  p.a = Eigen::MatrixXd::Random(rows, n);
  p.target = Eigen::VectorXd::Random(rows);
  for (int row = 1; row < rows; row += 3)
    p.target[row] = 0;
  p.nearness = 0.2 * Eigen::VectorXd::Random(n).cwiseAbs();
  p.start = Eigen::VectorXd::Constant(n, 1.0 / shapes);
  return p;
}

// Calls Solve until B rests, as frames do: the proximal term vanishes there.
Eigen::VectorXd SolveFast(const RandomProblem& p, BlendReport* report, double roughness = 0) {
  // Rows with a target are given as rows, the others, multiplied out, as the quadratic form.
  Vector<int> with, without;
  for (int row = 0; row < p.a.rows(); ++row)
    (p.target[row] != 0 ? with : without).push_back(row);
  const Eigen::MatrixXd rest = p.a(without, Eigen::all);
  const Eigen::VectorXd goal = p.target(with);
  test::DenseForm form(rest.transpose() * rest, p.a(with, Eigen::all), roughness);
  BlendProblem problem;
  problem.form = &form;
  problem.num_rows = static_cast<int>(goal.size());
  problem.goal = goal.data();
  problem.nearness = p.nearness.data();
  problem.square_root = p.square_root;
  problem.delta_squared = 1e-14;
  problem.proximal = 1e-10;
  BlendWeightStep step(ChooseSolveKernels<3>(), p.groups, p.shapes, static_cast<int>(p.a.rows()));
  Eigen::VectorXd b = p.start;
  for (int call = 0; call < 5; ++call)
    *report = step.Solve(problem, b.data());
  return b;
}

void ExpectFeasible(const RandomProblem& p, const Eigen::VectorXd& b) {
  EXPECT_GE(b.minCoeff(), 0);
  for (int g = 0; g < p.groups; ++g) {
    EXPECT_NEAR(b.segment(g * p.shapes, p.shapes).sum(), 1, 1e-12);
  }
}

// Away from f = 0: within each group all used weights have the smallest slope.
void ExpectOptimal(const RandomProblem& p, const Eigen::VectorXd& b) {
  const Eigen::VectorXd slope = p.Slope(b);
  for (int g = 0; g < p.groups; ++g) {
    const double level = slope.segment(g * p.shapes, p.shapes).minCoeff();
    for (int s = 0; s < p.shapes; ++s) {
      if (b[g * p.shapes + s] == 0) continue;
      EXPECT_NEAR(slope[g * p.shapes + s], level, 1e-6);
    }
  }
}

Eigen::VectorXd ProjectToSimplex(const Eigen::VectorXd& v) {
  Vector<double> sorted(v.data(), v.data() + v.size());
  std::sort(sorted.rbegin(), sorted.rend());
  double sum = 0, shift = 0;
  for (size_t i = 0; i < sorted.size(); ++i) {
    sum += sorted[i];
    const double candidate = (sum - 1) / static_cast<double>(i + 1);
    if (sorted[i] > candidate) shift = candidate;
  }
  return (v.array() - shift).max(0).matrix();
}

// Projected gradient with halving steps on the same objective: slow, and nothing in common.
double SolveSlowly(const RandomProblem& p) {
  Eigen::VectorXd b = p.start;
  double value = p.Objective(b), step = 1;
  for (int i = 0; i < 20000 && step > 1e-14; ++i) {
    Eigen::VectorXd next = b - step * p.Slope(b);
    for (int g = 0; g < p.groups; ++g) {
      next.segment(g * p.shapes, p.shapes) = ProjectToSimplex(next.segment(g * p.shapes, p.shapes));
    }
    const double next_value = p.Objective(next);
    if (next_value < value) {
      b = next;
      value = next_value;
      step *= 1.5;
    } else {
      step *= 0.5;
    }
  }
  return value;
}

TEST(BlendWeightStep, RandomProblems_MeetTheOptimalityConditions) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const int groups = 1 + static_cast<int>(seed % 7), shapes = 2 + static_cast<int>(seed % 5);
    const RandomProblem p = Make(groups, shapes, groups * shapes + 3, seed);
    BlendReport report;
    const Eigen::VectorXd b = SolveFast(p, &report);
    EXPECT_TRUE(report.converged) << seed;
    ExpectFeasible(p, b);
    ExpectOptimal(p, b);
  }
}

TEST(BlendWeightStep, WithoutTheSquareRoot_MeetsTheOptimalityConditions) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const int groups = 1 + static_cast<int>(seed % 7), shapes = 2 + static_cast<int>(seed % 5);
    RandomProblem p = Make(groups, shapes, groups * shapes + 3, seed);
    p.square_root = false;
    BlendReport report;
    const Eigen::VectorXd b = SolveFast(p, &report);
    EXPECT_TRUE(report.converged) << seed;
    ExpectFeasible(p, b);
    ExpectOptimal(p, b);
    EXPECT_LE(p.Objective(b), SolveSlowly(p) * (1 + 1e-6) + 1e-9) << seed;
  }
}

TEST(BlendWeightStep, RandomProblems_NoWorseThanAnIndependentSolver) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const RandomProblem p = Make(3, 4, seed % 2 == 0 ? 20 : 6, seed);
    BlendReport report;
    const double fast = p.Objective(SolveFast(p, &report));
    EXPECT_LE(fast, SolveSlowly(p) * (1 + 1e-6) + 1e-9) << seed;
  }
}

TEST(BlendWeightStep, RepeatedColumnsAndZeroColumns_StayFeasibleAndOptimal) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    RandomProblem p = Make(3, 4, 9, seed);
    p.a.col(1) = p.a.col(0);
    p.nearness[1] = p.nearness[0];
    p.a.col(6).setZero();
    p.a.col(7).setZero();
    BlendReport report;
    const Eigen::VectorXd b = SolveFast(p, &report);
    ASSERT_TRUE(b.allFinite()) << seed;
    ExpectFeasible(p, b);
    EXPECT_LE(p.Objective(b), SolveSlowly(p) * (1 + 1e-6) + 1e-9) << seed;
  }
}

TEST(BlendWeightStep, TargetThatAMixMatchesExactly_IsFoundAtTheKink) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    RandomProblem p = Make(2, 3, 12, seed);
    Eigen::VectorXd mix(6);
    mix << 0.25, 0.75, 0, 0, 0.5, 0.5;
    p.target = p.a * mix;
    p.nearness.setConstant(0.01);  // equal for all: only f decides
    BlendReport report;
    const Eigen::VectorXd b = SolveFast(p, &report);
    EXPECT_LT((b - mix).cwiseAbs().maxCoeff(), 1e-5) << seed;
  }
}

// However rough the gradient is, as long as it says so, the answer is the exact one's.
TEST(BlendWeightStep, RoughGradient_ChangesNoAnswer) {
  double far_off = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    RandomProblem p = Make(5, 4, 12, seed);
    p.square_root = seed % 2 == 0;
    for (int i = 0; i < p.start.size(); ++i)
      p.start[i] = i % p.shapes == 0 ? 1 : 0;  // all others are yet to be found
    BlendReport report;
    const Eigen::VectorXd exact = SolveFast(p, &report);
    far_off = std::max(far_off, (exact - p.start).norm());
    for (const double roughness : {1e-6, 1e-2, 3.0}) {
      const Eigen::VectorXd b = SolveFast(p, &report, roughness);
      EXPECT_TRUE(report.converged) << seed;
      EXPECT_NEAR(p.Objective(b), p.Objective(exact), 1e-9) << seed << ' ' << roughness;
      EXPECT_LT((b - exact).cwiseAbs().maxCoeff(), 1e-5) << seed << ' ' << roughness;
    }
  }
  EXPECT_GT(far_off, 0.5) << "there must be something to find";
}

TEST(BlendWeightStep, NothingToChooseBy_KeepsTheStart) {
  RandomProblem p = Make(2, 3, 4, 1);
  p.a.setZero();
  p.target.setZero();
  p.nearness.setZero();
  p.start << 0.2, 0.3, 0.5, 1, 0, 0;
  BlendReport report;
  EXPECT_LT((SolveFast(p, &report) - p.start).norm(), 1e-12);
}

TEST(BlendWeightStep, OneShape_IsOne) {
  const RandomProblem p = Make(4, 1, 6, 1);
  BlendReport report;
  EXPECT_EQ(SolveFast(p, &report), Eigen::VectorXd::Ones(4));
}

}  // namespace
}  // namespace limber
