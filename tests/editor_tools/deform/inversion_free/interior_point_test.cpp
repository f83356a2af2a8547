// The interior point method against algorithm 1: two independent ways to one optimum.
#include "deform/inversion_free/interior_point.h"

#include "deform/inversion_free/plain_solver.h"
#include "made_elements.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace limber::deform {
namespace {

using test::kDegree;

template <int D>
void ExpectSameOptimum(const char* name, const InversionFreeProblem<D>& problem,
                       const InversionFreeOptions& options) {
  const auto energy = FullEnergy<D>::Create(problem, options);
  ASSERT_TRUE(energy.ok()) << energy.status().message();
  typename SimplexMesh<D>::Positions start, plain, x;
  ASSERT_TRUE(SolveUnconstrained(*energy, &start).ok());
  plain = x = start;
  InversionFreeReport plain_report, report;
  ASSERT_TRUE(SolvePlainly(*energy, {}, &plain, &plain_report).ok());
  InteriorPoint<D> solver(*energy, options.smallest_stretch);
  ASSERT_TRUE(solver.Solve({}, {}, &x, &report).ok());
  const double gap = report.duality_gap;
  Measure(*energy, options, x, 0, &report);
  std::printf("%s: %d steps, algorithm 1 %d; energy %.10g; gap %.1e, smallest volume %.2e\n", name,
              report.iterations, plain_report.iterations, report.energy, gap,
              report.smallest_volume);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.iterations, 40);
  EXPECT_EQ(report.num_inverted, 0);
  EXPECT_GT(report.smallest_stretch, 0.9 * options.smallest_stretch);
  EXPECT_NEAR(report.energy, energy->Value(plain, 0), 1e-8 * (report.energy + 1e-3));
  EXPECT_LT((x - plain).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(InteriorPoint, Swirls_HaveTheOptimumOfAlgorithm1) {
  const TriangleMesh grid = test::MakeGrid(20);
  for (const double degrees : {0.0, 90.0, 180.0, 270.0}) {
    ExpectSameOptimum(
        "swirl",
        test::MakeProblem(grid, test::Swirl(grid, degrees * kDegree), HandleWeightKind::kHarmonic),
        {});
  }
}

TEST(InteriorPoint, TwistedAndStretchedBars_HaveTheOptimumOfAlgorithm1) {
  const TetMesh bar = test::MakeBar(3, 3, 6);
  for (const double degrees : {90.0, 180.0, 270.0}) {
    InversionFreeOptions options;
    options.incompressibility = 20;
    ExpectSameOptimum("bar",
                      test::MakeProblem(bar, test::TwistBar(bar, degrees * kDegree, 2.5),
                                        HandleWeightKind::kHarmonic),
                      options);
  }
}

TEST(InteriorPoint, AnyStart_AndIteratesThatCanBeSeenAndStopped) {
  const TriangleMesh grid = test::MakeGrid(12);
  const auto problem =
      test::MakeProblem(grid, test::Swirl(grid, 180 * kDegree), HandleWeightKind::kHarmonic);
  const auto energy = FullEnergy<2>::Create(problem, {});
  ASSERT_TRUE(energy.ok());
  InteriorPoint<2> solver(*energy, 1e-6);
  TriangleMesh::Positions first = grid.rest;
  TriangleMesh::Positions second = TriangleMesh::Positions::Random(grid.num_vertices(), 2);
  InversionFreeReport report;
  ASSERT_TRUE(solver.Solve({}, {}, &first, &report).ok());
  ASSERT_TRUE(report.converged);
  ASSERT_TRUE(solver.Solve({}, {}, &second, &report).ok());
  ASSERT_TRUE(report.converged);
  EXPECT_LT((first - second).cwiseAbs().maxCoeff(), 1e-5);
  int seen = 0;
  const auto stop = [&](const TriangleMesh::Positions& x, int iteration) {
    EXPECT_EQ(iteration, seen++);
    EXPECT_TRUE(x.allFinite());
    return iteration < 3;
  };
  TriangleMesh::Positions early = grid.rest;
  ASSERT_TRUE(solver.Solve({}, stop, &early, &report).ok());
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(seen, 4);
}

}  // namespace
}  // namespace limber::deform
