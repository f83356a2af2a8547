#include "solve/stretch_limit.h"

#include "core/vector.h"
#include "support/counting_allocator.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <random>

namespace limber {
namespace {

using Eigen::MatrixXd;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Points with limits of their own, beside what the class takes.
struct Case {
  Vector<int> handles;
  Vector<float> reach;
  Vector<double> weights;
  double limit = 1;
  MatrixXd targets;  // k x c

  StretchLimit::Problem Problem() const {
    return {static_cast<size_t>(targets.rows()),
            handles,
            reach.data(),
            handles.size(),
            weights.data(),
            limit};
  }

  double Limit(Eigen::Index a, Eigen::Index b) const {
    return limit * static_cast<double>(reach[static_cast<size_t>(a * targets.cols() + b)]);
  }

  // Largest excess over a limit, of the limit.
  double Violation(const MatrixXd& x) const {
    double worst = 0;
    for (Eigen::Index a = 0; a < x.cols(); ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        if (Limit(a, b) > 0)
          worst = std::max(worst, (x.col(a) - x.col(b)).norm() / Limit(a, b) - 1);
      }
    }
    return worst;
  }

  double Distance(const MatrixXd& x, const MatrixXd& y) const {
    double sum = 0;
    for (Eigen::Index a = 0; a < x.cols(); ++a) {
      const double weight = weights[static_cast<size_t>(a)];
      const double squared = (x.col(a) - y.col(a)).squaredNorm();
      if (squared > 0) sum += weight * squared;
    }
    return std::sqrt(sum);
  }
};

class Cases {
 public:
  explicit Cases(unsigned seed) : engine_(seed) {}

  double Number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }

  // Points on a made body with its own distances as reach; targets thrown about.
  Case Make(int count, Eigen::Index k, double throw_by) {
    Case made;
    made.handles.resize(static_cast<size_t>(count));
    std::iota(made.handles.begin(), made.handles.end(), 0);
    MatrixXd rest(k, count);
    made.targets.resize(k, count);
    for (Eigen::Index p = 0; p < count; ++p) {
      made.weights.push_back(Number(0.2, 5));
      for (Eigen::Index c = 0; c < k; ++c) {
        rest(c, p) = Number(-1, 1);
        made.targets(c, p) = rest(c, p) + throw_by * Number(-1, 1);
      }
    }
    for (Eigen::Index a = 0; a < count; ++a) {
      for (Eigen::Index b = 0; b < count; ++b)
        made.reach.push_back(static_cast<float>(1.1 * (rest.col(a) - rest.col(b)).norm()));
    }
    made.limit = Number(1, 1.5);
    return made;
  }

 private:
  std::mt19937 engine_;
};

MatrixXd Project(const Case& problem, StretchLimit::Outcome* outcome = nullptr) {
  StretchLimit limit(problem.handles.size());
  MatrixXd x = problem.targets;
  const StretchLimit::Outcome result = limit.Project(problem.Problem(), x.data());
  if (outcome != nullptr) *outcome = result;
  return x;
}

// x is the projection of X exactly where no feasible y makes an acute angle with X - x.
void ExpectIsProjection(const Case& problem, const MatrixXd& x, Cases* cases) {
  ASSERT_LT(problem.Violation(x), 2e-6);
  const double scale = problem.Distance(problem.targets, x);
  for (int trial = 0; trial < 30; ++trial) {
    Case other = problem;  // a feasible point near by
    for (Eigen::Index i = 0; i < other.targets.size(); ++i)
      other.targets.data()[i] = x.data()[i] + cases->Number(-0.5, 0.5);
    const MatrixXd y = Project(other);
    double inner = 0;
    for (Eigen::Index p = 0; p < x.cols(); ++p) {
      inner += problem.weights[static_cast<size_t>(p)] *
               (problem.targets.col(p) - x.col(p)).dot(y.col(p) - x.col(p));
    }
    EXPECT_LE(inner, 1e-4 * scale * (1 + scale));
  }
}

TEST(StretchLimit, RandomProblems_AreProjectedExactly) {
  Cases cases(1);
  for (int round = 0; round < 200; ++round) {
    const Case problem = cases.Make(2 + round % 12, 2 + round % 2, cases.Number(0.2, 3));
    StretchLimit::Outcome outcome;
    const MatrixXd x = Project(problem, &outcome);
    EXPECT_TRUE(outcome.is_feasible) << round << ": " << outcome.violation;
    ExpectIsProjection(problem, x, &cases);
  }
}

TEST(StretchLimit, WithinReach_NothingMovesByABit) {
  Cases cases(2);
  for (int round = 0; round < 50; ++round) {
    const Case problem = cases.Make(8, 3, 0.02);
    if (problem.Violation(problem.targets) > 0) continue;
    StretchLimit::Outcome outcome;
    EXPECT_EQ(Project(problem, &outcome), problem.targets);
    EXPECT_EQ(outcome.iterations, 0);
  }
  Case alone = cases.Make(1, 3, 5);
  EXPECT_EQ(Project(alone), alone.targets);
}

TEST(StretchLimit, TwoPoints_MeetWhereTheirWeightsSay) {
  Case problem;
  problem.handles = {0, 1};
  problem.reach = {0, 1, 1, 0};
  problem.weights = {3, 1};
  problem.limit = 2;
  problem.targets = MatrixXd::Zero(3, 2);
  problem.targets(0, 1) = 6;
  MatrixXd x = Project(problem);
  EXPECT_NEAR(x(0, 0), 1, 1e-9);
  EXPECT_NEAR(x(0, 1), 3, 1e-9);
  problem.weights = {kInfinite, 1};  // a foot that stands
  x = Project(problem);
  EXPECT_EQ(x(0, 0), 0);
  EXPECT_NEAR(x(0, 1), 2, 1e-9);
}

TEST(StretchLimit, Projection_IsNotExpansive) {
  Cases cases(3);
  for (int round = 0; round < 200; ++round) {
    Case one = cases.Make(9, 3, 1.5);
    Case other = one;
    const double step = std::pow(10, cases.Number(-4, 0));
    for (Eigen::Index i = 0; i < other.targets.size(); ++i)
      other.targets.data()[i] += step * cases.Number(-1, 1);
    const double before = one.Distance(one.targets, other.targets);
    EXPECT_LE(one.Distance(Project(one), Project(other)), before * (1 + 1e-5) + 1e-6);
  }
}

TEST(StretchLimit, AgainAndTurned_IsTheSame) {
  Cases cases(4);
  for (int round = 0; round < 50; ++round) {
    const Case problem = cases.Make(7, 3, 2);
    const MatrixXd x = Project(problem);
    Case again = problem;
    again.targets = x;
    EXPECT_LT((Project(again) - x).norm(), 1e-5);
    Case turned = problem;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(cases.Number(-3, 3), Eigen::Vector3d(1, 2, -1).normalized()).matrix();
    const Eigen::Vector3d shift(10, -3, 0.5);
    turned.targets = (turn * problem.targets).colwise() + shift;
    EXPECT_LT((Project(turned) - ((turn * x).colwise() + shift)).norm(), 1e-5);
  }
}

TEST(StretchLimit, DegenerateProblems_StayFiniteAndFeasible) {
  Cases cases(5);
  Case coincident = cases.Make(6, 3, 1);
  coincident.targets.setConstant(3);
  EXPECT_EQ(Project(coincident), coincident.targets);
  Case line = cases.Make(8, 3, 1);
  line.targets.setZero();
  for (Eigen::Index p = 0; p < 8; ++p)
    line.targets(0, p) = 100 * static_cast<double>(p);
  StretchLimit::Outcome outcome;
  const MatrixXd x = Project(line, &outcome);
  EXPECT_TRUE(x.allFinite());
  EXPECT_LT(line.Violation(x), 2e-6);
  Case one_far = cases.Make(10, 3, 0);
  one_far.targets(1, 4) = 1e5;
  std::fill(one_far.weights.begin(), one_far.weights.end(), kInfinite);
  one_far.weights[4] = 1;
  const MatrixXd pulled = Project(one_far);
  EXPECT_LT(one_far.Violation(pulled), 2e-6);
  for (Eigen::Index p = 0; p < 10; ++p) {
    if (p == 4) continue;
    EXPECT_EQ(pulled.col(p), one_far.targets.col(p));
  }
}

TEST(StretchLimit, ImmovablePointsTooFarApart_AreReported) {
  Cases cases(6);
  Case problem = cases.Make(4, 3, 0);
  problem.targets.col(0).setConstant(50);
  problem.weights[0] = problem.weights[1] = kInfinite;
  StretchLimit::Outcome outcome;
  const MatrixXd x = Project(problem, &outcome);
  EXPECT_FALSE(outcome.is_feasible);
  EXPECT_GT(outcome.violation, 1);
  EXPECT_TRUE(x.allFinite());
  EXPECT_EQ(x.col(0), problem.targets.col(0));
}

TEST(StretchLimit, PairsWithoutALimit_ArePassedOver) {
  Cases cases(7);
  Case problem = cases.Make(3, 2, 0);
  std::fill(problem.reach.begin(), problem.reach.end(), 0.0f);
  problem.targets *= 1e6;
  EXPECT_EQ(Project(problem), problem.targets);
}

TEST(StretchLimit, Project_AllocatesNothing) {
  Cases cases(8);
  const Case problem = cases.Make(20, 3, 3);
  StretchLimit limit(20);
  MatrixXd x = problem.targets;
  const int64_t before = test::AllocationCount();
  (void)limit.Project(problem.Problem(), x.data());
  EXPECT_EQ(test::AllocationCount(), before);
}

}  // namespace
}  // namespace limber
