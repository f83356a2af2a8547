#include "bake/bounded_quadratic.h"

#include "core/vector.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

bool KeepGoing() {
  return true;
}

// One problem alone.
void Solve(const MatrixXd& Q, const VectorXd& c, const std::function<bool()>& keep_going,
           VectorXd* x, BoundedQuadraticReport* report) {
  *report = BoundedQuadratic(Q.sparseView()).Solve(c, keep_going, x);
}

// The optimum by projected coordinate descent, one exact coordinate after the other: slow, simple,
// and with nothing in common with an interior point method.
VectorXd SolveSlowly(const MatrixXd& Q, const VectorXd& c) {
  VectorXd x = VectorXd::Constant(c.size(), 0.5);
  for (int sweep = 0; sweep < 1000000; ++sweep) {
    double change = 0;
    for (Eigen::Index i = 0; i < c.size(); ++i) {
      const double gradient = Q.row(i) * x + c(i);
      const double moved = std::clamp(x(i) - gradient / Q(i, i), 0.0, 1.0);
      change = std::max(change, std::abs(moved - x(i)));
      x(i) = moved;
    }
    if (change < 1e-15) break;
  }
  return x;
}

struct Problem {
  MatrixXd Q;
  VectorXd c;
};

// Random, with an optimum at which about a third of the variables is at each bound.
Problem RandomProblem(int size, double condition, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const MatrixXd noise = MatrixXd::NullaryExpr(size, size, [&] { return uniform(random); });
  const MatrixXd rotation = Eigen::HouseholderQR<MatrixXd>(noise).householderQ();
  VectorXd spectrum(size);
  for (int i = 0; i < size; ++i)
    spectrum(i) = std::pow(condition, -double(i) / (size - 1));
  Problem problem;
  problem.Q = rotation * spectrum.asDiagonal() * rotation.transpose();
  problem.Q = 0.5 * (problem.Q + problem.Q.transpose()).eval();
  const VectorXd centre = VectorXd::NullaryExpr(size, [&] { return 0.5 + 1.5 * uniform(random); });
  problem.c = -problem.Q * centre;
  return problem;
}

TEST(BoundedQuadratic, AgreesWithCoordinateDescent) {
  for (const uint32_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const Problem problem = RandomProblem(40, 100, seed);
    VectorXd x;
    BoundedQuadraticReport report;
    Solve(problem.Q, problem.c, KeepGoing, &x, &report);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.stationarity, 1e-8);
    EXPECT_LE(report.iterations, 30);
    const VectorXd expected = SolveSlowly(problem.Q, problem.c);
    EXPECT_GT((expected.array() == 0).count(), 2);
    EXPECT_GT((expected.array() == 1).count(), 2);
    EXPECT_LT((x - expected).lpNorm<Eigen::Infinity>(), 1e-7);
  }
}

TEST(BoundedQuadratic, UnitsOfTheObjectiveDoNotMatter) {
  const Problem problem = RandomProblem(30, 1e4, 11);
  VectorXd reference;
  BoundedQuadraticReport report;
  Solve(problem.Q, problem.c, KeepGoing, &reference, &report);
  for (const double scale : {1e-12, 1e12}) {
    VectorXd x;
    Solve(scale * problem.Q, scale * problem.c, KeepGoing, &x, &report);
    EXPECT_TRUE(report.converged);
    EXPECT_LT((x - reference).lpNorm<Eigen::Infinity>(), 1e-9);
  }
}

// A problem in whose optimum the variables from `held` on are at zero, and pressed there.
Problem ProblemWithAnEnd(int size, int held, uint32_t seed) {
  Problem problem = RandomProblem(size, 100, seed);
  for (int i = held; i < size; ++i)
    problem.c(i) = 2 + problem.Q.row(i).head(held).cwiseAbs().sum();
  return problem;
}

Vector<int> UpTo(int count) {
  Vector<int> numbers(static_cast<size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

TEST(BoundedQuadratic, HeldWhereTheOptimumIsZero_GivesTheSameOptimum) {
  const Problem problem = ProblemWithAnEnd(40, 25, 6);
  const Eigen::SparseMatrix<double> Q = problem.Q.sparseView();
  VectorXd whole, part;
  const BoundedQuadraticReport of_whole = BoundedQuadratic(Q).Solve(problem.c, KeepGoing, &whole);
  const BoundedQuadraticReport of_part =
      BoundedQuadratic(Q, UpTo(40), UpTo(25)).Solve(problem.c, KeepGoing, &part);
  EXPECT_TRUE(of_whole.converged);
  EXPECT_TRUE(of_part.converged);
  EXPECT_LE(of_part.stationarity, 1e-8);
  EXPECT_EQ(part.tail(15), VectorXd::Zero(15));
  EXPECT_LT((part - whole).lpNorm<Eigen::Infinity>(), 1e-6);
}

// The fourth variable alone belongs above zero, and is held.
TEST(BoundedQuadratic, HeldWhereTheOptimumIsNotZero_SaysByHowMuch) {
  Problem problem = ProblemWithAnEnd(40, 25, 6);
  problem.c(30) = -0.5 - problem.Q.row(30).head(25).cwiseAbs().sum();
  VectorXd x;
  const BoundedQuadraticReport report =
      BoundedQuadratic(problem.Q.sparseView(), UpTo(40), UpTo(25)).Solve(problem.c, KeepGoing, &x);
  EXPECT_FALSE(report.converged);
  const double pull =
      -(problem.Q.row(30) * x + problem.c(30)) / problem.c.lpNorm<Eigen::Infinity>();
  EXPECT_NEAR(report.stationarity, pull, 1e-12);
  EXPECT_LT(report.iterations, 60) << "it goes on although nothing will change";
}

TEST(BoundedQuadratic, AllHeld_StaysAtZero) {
  VectorXd x;
  const BoundedQuadraticReport report =
      BoundedQuadratic(MatrixXd::Identity(3, 3).sparseView(), UpTo(3), {})
          .Solve(VectorXd::Ones(3), KeepGoing, &x);
  EXPECT_EQ(x, VectorXd::Zero(3));
  EXPECT_TRUE(report.converged);
}

TEST(BoundedQuadratic, OptimumOnACorner_IsFound) {
  const Problem problem{MatrixXd::Identity(5, 5), (VectorXd(5) << 3, -3, 0, -0.5, -1).finished()};
  VectorXd x;
  BoundedQuadraticReport report;
  Solve(problem.Q, problem.c, KeepGoing, &x, &report);
  EXPECT_TRUE(report.converged);
  // The third and fifth are degenerate: at the bound without a force that holds them there.
  EXPECT_LT((x - (VectorXd(5) << 0, 1, 0, 0.5, 1).finished()).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_GE(x.minCoeff(), 0);
  EXPECT_LE(x.maxCoeff(), 1);
}

TEST(BoundedQuadratic, NoPull_StaysAtZero) {
  VectorXd x;
  BoundedQuadraticReport report;
  Solve(MatrixXd::Identity(3, 3), VectorXd::Zero(3), KeepGoing, &x, &report);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(x, VectorXd::Zero(3));
}

// Everything is pushed down: the objective at the optimum is zero, and nothing can be relative to
// it.
TEST(BoundedQuadratic, OptimumAtZero_IsReached) {
  const Problem problem = RandomProblem(30, 100, 4);
  VectorXd c(30), x;
  for (int i = 0; i < 30; ++i)
    c(i) = i % 3 == 0 ? 0 : 1 + 0.1 * i;
  BoundedQuadraticReport report;
  Solve(problem.Q, c, KeepGoing, &x, &report);
  EXPECT_TRUE(report.converged) << report.gap << " " << report.stationarity;
  EXPECT_LT(x.maxCoeff(), 1e-6);
}

TEST(BoundedQuadratic, Stopped_SaysSo) {
  const Problem problem = RandomProblem(20, 100, 3);
  int allowed = 3;
  VectorXd x;
  BoundedQuadraticReport report;
  Solve(
      problem.Q, problem.c, [&allowed] { return allowed-- > 0; }, &x, &report);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_GE(x.minCoeff(), 0);
  EXPECT_LE(x.maxCoeff(), 1);
}

TEST(BoundedQuadratic, IndefiniteOrNotFinite_IsReportedNotReturnedAsSolved) {
  VectorXd x;
  BoundedQuadraticReport report;
  const MatrixXd indefinite = (VectorXd(2) << -100, 1).finished().asDiagonal();
  Solve(indefinite, VectorXd::Ones(2), KeepGoing, &x, &report);
  EXPECT_FALSE(report.converged);
  MatrixXd not_finite = MatrixXd::Identity(2, 2);
  not_finite(1, 1) = std::nan("");
  Solve(not_finite, VectorXd::Ones(2), KeepGoing, &x, &report);
  EXPECT_FALSE(report.converged);
}

}  // namespace
}  // namespace limber::bake
