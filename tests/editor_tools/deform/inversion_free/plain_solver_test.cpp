#include "deform/inversion_free/plain_solver.h"

#include "made_elements.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>

namespace limber::deform {
namespace {

using test::kDegree;

template <int D>
struct Solution {
  typename SimplexMesh<D>::Positions x;
  InversionFreeReport report, unconstrained;
};

template <int D>
Solution<D> Solve(const InversionFreeProblem<D>& problem, const InversionFreeOptions& options,
                  const typename SimplexMesh<D>::Positions* start = nullptr) {
  Solution<D> solution;
  const auto energy = FullEnergy<D>::Create(problem, options);
  EXPECT_TRUE(energy.ok()) << energy.status().message();
  if (!energy.ok()) return solution;
  EXPECT_TRUE(SolveUnconstrained(*energy, &solution.x).ok());
  Measure(*energy, options, solution.x, 0, &solution.unconstrained);
  if (start != nullptr) solution.x = *start;
  const PlainSolverOptions plain;
  EXPECT_TRUE(SolvePlainly(*energy, plain, &solution.x, &solution.report).ok());
  Measure(*energy, options, solution.x, plain.last_tau, &solution.report);
  return solution;
}

template <int D>
void ExpectOptimum(const char* name, const Solution<D>& solution) {
  const InversionFreeReport& r = solution.report;
  std::printf(
      "%s: %d inverted before, %d steps; smallest volume %.2e, stretch %.2e; primal %.1e, dual "
      "%.1e, gap %.1e; furthest from its target %.2g\n",
      name, solution.unconstrained.num_inverted, r.iterations, r.smallest_volume,
      r.smallest_stretch, r.primal_violation, r.dual_violation, r.duality_gap, r.target_miss);
  EXPECT_TRUE(r.converged);
  EXPECT_TRUE(r.feasible);
  EXPECT_EQ(r.num_inverted, 0);
  EXPECT_GT(r.smallest_volume, 0);
  EXPECT_LT(r.primal_violation, 1e-11);
  EXPECT_LT(r.dual_violation, 1e-11);
  EXPECT_LT(r.duality_gap, 1e-10);
}

TEST(PlainSolver, Swirls_InvertNothing) {
  const TriangleMesh grid = test::MakeGrid(20);
  for (const double degrees : {90.0, 180.0, 270.0}) {
    const auto problem =
        test::MakeProblem(grid, test::Swirl(grid, degrees * kDegree), HandleWeightKind::kHarmonic);
    const Solution<2> solution = Solve(problem, {});
    ExpectOptimum("swirl", solution);
    if (degrees > 90) {
      EXPECT_GT(solution.unconstrained.num_inverted, 0) << "there was nothing to do";
    }
    EXPECT_LT(solution.report.iterations, 150);
  }
}

TEST(PlainSolver, TwistedAndStretchedBars_InvertNothing) {
  const TetMesh bar = test::MakeBar(3, 3, 6);
  for (const double degrees : {90.0, 180.0, 270.0}) {
    const auto problem = test::MakeProblem(bar, test::TwistBar(bar, degrees * kDegree, 2.5),
                                           HandleWeightKind::kHarmonic);
    InversionFreeOptions options;
    options.incompressibility = 20;
    const Solution<3> solution = Solve(problem, options);
    ExpectOptimum("bar", solution);
    EXPECT_GT(solution.unconstrained.num_inverted, 0) << "there was nothing to do";
  }
}

// A bar whose elements are asked to turn, each its own way.
Solution<3> SolveRandom(double size, unsigned seed) {
  const TetMesh bar = test::MakeBar(2, 2, 3);
  auto problem = test::MakeProblem(bar, test::TwistBar(bar, 0), HandleWeightKind::kHarmonic);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, size);
  for (Eigen::Matrix3d& rotation : problem.rotations) {
    HandleMotion<3> any;
    any.turn = {noise(random), noise(random), noise(random)};
    rotation = any.Rotation();
  }
  return Solve(problem, {});
}

TEST(PlainSolver, RandomRotations_InvertNothing) {
  for (unsigned seed = 0; seed < 3; ++seed)
    ExpectOptimum("random", SolveRandom(0.5, seed));
}

TEST(PlainSolver, WithoutAnyShapeThatIsAllowed_ItIsTold) {
  const Solution<3> solution = SolveRandom(2, 1);
  EXPECT_FALSE(solution.report.feasible);
  EXPECT_TRUE(solution.x.allFinite());
  EXPECT_LT(solution.report.iterations, 1000) << "and it ends";
}

TEST(PlainSolver, AnyStartAndAnyPenalty_ReachTheSameShape) {
  const TriangleMesh grid = test::MakeGrid(12);
  const auto problem =
      test::MakeProblem(grid, test::Swirl(grid, 180 * kDegree), HandleWeightKind::kHarmonic);
  const Solution<2> first = Solve(problem, {});
  const TriangleMesh::Positions elsewhere = TriangleMesh::Positions::Random(grid.num_vertices(), 2);
  const Solution<2> second = Solve(problem, {}, &elsewhere);
  EXPECT_LT((first.x - second.x).cwiseAbs().maxCoeff(), 1e-8);
  for (const PenaltyKind kind : {PenaltyKind::kCubic, PenaltyKind::kSpline}) {
    InversionFreeOptions options;
    options.penalty = kind;
    const Solution<2> other = Solve(problem, options);
    std::printf("penalty %d: %d steps, of the quadratic one %d\n", static_cast<int>(kind),
                other.report.iterations, first.report.iterations);
    EXPECT_LT((first.x - other.x).cwiseAbs().maxCoeff(), 1e-5) << static_cast<int>(kind);
    EXPECT_EQ(other.report.num_inverted, 0);
  }
}

TEST(PlainSolver, WishesThatCannotBeGranted_AreGrantedAsFarAsTheyCan) {
  const TetMesh bar = test::MakeBar(2, 2, 4);
  Vector<HandleMotion<3>> handles = test::TwistBar(bar, 0);
  handles[1].translation = {0, 0, -3};  // beyond the other end: the bar would be turned over
  const Solution<3> solution =
      Solve(test::MakeProblem(bar, handles, HandleWeightKind::kHarmonic), {});
  EXPECT_GT(solution.unconstrained.num_inverted, 0);
  EXPECT_EQ(solution.report.num_inverted, 0);
  EXPECT_GT(solution.report.target_miss, 0.1) << "and it is told";
}

TEST(PlainSolver, RigidWishes_AreGrantedExactly) {
  const TetMesh bar = test::MakeBar(2, 2, 3);
  Vector<HandleMotion<3>> handles = test::TwistBar(bar, 0);
  for (HandleMotion<3>& handle : handles) {
    handle.turn = {0.3, -0.8, 1.2};
    handle.translation = {1, 2, 3};
  }
  const Solution<3> solution =
      Solve(test::MakeProblem(bar, handles, HandleWeightKind::kHarmonic), {});
  for (int v = 0; v < bar.num_vertices(); ++v) {
    const Eigen::Vector3d expected = handles[0].Apply(bar.rest.row(v).transpose());
    EXPECT_LT((solution.x.row(v).transpose() - expected).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace limber::deform
