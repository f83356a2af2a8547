// One blend for the whole character is the convex step with every group's sum.
#include "solve/convex_step.h"

#include "runtime/solve/dense_form.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber {
namespace {

constexpr int kGroups = 4, kShapes = 3, kRows = 5;

struct Uniform {
  Eigen::MatrixXd quadratic, rows;
  Eigen::VectorXd goal, nearness;

  explicit Uniform(unsigned seed) {
    srand(seed);
    const int blocks = kGroups * kShapes;
    const Eigen::MatrixXd factor = Eigen::MatrixXd::Random(9, blocks);
    quadratic = factor.transpose() * factor;
    rows = Eigen::MatrixXd::Random(kRows, blocks);
    goal = Eigen::VectorXd::Random(kRows);
    nearness = 0.2 * Eigen::VectorXd::Random(blocks).cwiseAbs();
  }

  // Of one blend, [S].
  double Objective(const Eigen::VectorXd& blend) const {
    const Eigen::VectorXd spread = blend.replicate(kGroups, 1);
    const double f =
        0.5 * spread.dot(quadratic * spread) + 0.5 * (rows * spread - goal).squaredNorm();
    return std::sqrt(f) + nearness.dot(spread);
  }
};

Eigen::VectorXd Solve(const Uniform& p, double roughness, BlendReport* report) {
  test::DenseForm form(p.quadratic, p.rows, roughness);
  BlendProblem problem;
  problem.form = &form;
  problem.num_rows = kRows;
  problem.goal = p.goal.data();
  problem.nearness = p.nearness.data();
  problem.delta_squared = 1e-14;
  problem.proximal = 1e-10;
  ConvexStep step(ChooseSolveKernels<3>(), kGroups, kShapes, kRows);
  Eigen::VectorXd blend = Eigen::VectorXd::Constant(kGroups * kShapes, 1.0 / kShapes);
  for (int call = 0; call < 5; ++call)
    *report = step.Solve(problem, false, blend.data());
  return blend;
}

TEST(ConvexStep, OneBlend_IsTheSameInEveryGroupAndTheBestOnAGrid) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const Uniform p(seed);
    for (const double roughness : {0.0, 1e-2}) {
      BlendReport report;
      const Eigen::VectorXd blend = Solve(p, roughness, &report);
      EXPECT_TRUE(report.converged);
      for (int i = 0; i < kGroups * kShapes; ++i)
        EXPECT_EQ(blend[i], blend[i % kShapes]);
      const Eigen::VectorXd one = blend.head(kShapes);
      EXPECT_GE(one.minCoeff(), 0);
      EXPECT_NEAR(one.sum(), 1, 1e-12);
      double best = 1e9, worst = 0;
      for (int a = 0; a <= 100; ++a) {
        for (int b = 0; a + b <= 100; ++b) {
          const Eigen::Vector3d grid(a * 0.01, b * 0.01, (100 - a - b) * 0.01);
          best = std::min(best, p.Objective(grid));
          worst = std::max(worst, p.Objective(grid));
        }
      }
      EXPECT_LE(p.Objective(one), best + 1e-9) << seed;
      EXPECT_GT(p.Objective(one), best - 0.05 * worst) << "the grid is fine enough to tell";
    }
  }
}

}  // namespace
}  // namespace limber
