// What lies beyond a handle's support may be left out of its problem, and the weights are the same.
#include "bake/weight_supports.h"

#include "bake/bounded_quadratic.h"
#include "bake/coarse_surface.h"
#include "bake/handle_solver.h"
#include "bake/quadratic_problem.h"
#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace limber::bake {
namespace {

using Eigen::VectorXd;
using geometry::RobustLaplacian;
using geometry::SolveMesh;

// A long strip with a handle every ten squares: each reaches its neighbours and hardly further.
struct Strip {
  SolveMesh mesh = test::MakeGrid(120, 30);
  Vector<int> handles;
  RobustLaplacian surface = geometry::MakeRobustLaplacian(mesh);

  Strip() {
    for (int x = 10; x <= 110; x += 20)
      handles.push_back(15 * 121 + x);
  }

  QuadraticProblem Problem() const {
    return SplitOffHandles(BiharmonicForm(surface.laplacian, surface.areas), handles);
  }
};

VectorXd OverTheWhole(const QuadraticProblem& problem, int h) {
  VectorXd x;
  const BoundedQuadraticReport report = BoundedQuadratic(problem.Q).Solve(
      problem.c.col(h), [] { return true; }, &x);
  EXPECT_TRUE(report.converged);
  return x;
}

TEST(WeightSupports, HoldEveryWeightAboveZero_AndLittleElse) {
  const Strip strip;
  const QuadraticProblem problem = strip.Problem();
  const WeightSupports supports(strip.surface, strip.handles, 1);
  for (const int h : {0, 2, 5}) {
    const VectorXd x = OverTheWhole(problem, h);
    const Vector<bool> is_near = supports.Around(h, 2);
    double outside = 0;
    for (size_t i = 0; i < problem.free_vertices.size(); ++i) {
      if (!is_near[size_t(problem.free_vertices[i])])
        outside = std::max(outside, x(Eigen::Index(i)));
    }
    EXPECT_LT(outside, 1e-4) << h;
    const auto count = std::count(is_near.begin(), is_near.end(), true);
    EXPECT_LT(count, (h == 2 ? 0.75 : 0.6) * double(is_near.size())) << h;
    EXPECT_TRUE(is_near[size_t(strip.handles[size_t(h)])]);
  }
}

TEST(WeightSupports, GrowWithTheRings_UpToAll) {
  const Strip strip;
  const WeightSupports supports(strip.surface, strip.handles, 1);
  auto last = std::ptrdiff_t{0};
  for (const int rings : {0, 1, 2, 4}) {
    const Vector<bool> is_near = supports.Around(0, rings);
    const auto count = std::count(is_near.begin(), is_near.end(), true);
    EXPECT_GT(count, last);
    last = count;
  }
  const Vector<bool> all = supports.Around(0, 1000);
  EXPECT_EQ(std::count(all.begin(), all.end(), true), std::ptrdiff_t(all.size()));
}

TEST(WeightSupports, SmallSurfaces_AreReachedWhole) {
  const SolveMesh mesh = test::MakeGrid(20, 20);
  const Vector<int> handles = {0, 440};
  const WeightSupports supports(geometry::MakeRobustLaplacian(mesh), handles, 1);
  const Vector<bool> is_near = supports.Around(1, 0);
  EXPECT_EQ(std::count(is_near.begin(), is_near.end(), true), 441);
}

// Handles side by side fall into one aggregate.
TEST(WeightSupports, CrowdedHandles_HaveTheirOwn) {
  Strip strip;
  strip.handles.push_back(strip.handles[1] + 1);
  const WeightSupports supports(strip.surface, strip.handles, 1);
  for (const size_t h : {size_t{1}, strip.handles.size() - 1})
    EXPECT_TRUE(supports.Around(int(h), 0)[size_t(strip.handles[h])]);
}

TEST(HandleSolver, GivesTheOptimumOfTheWhole) {
  const Strip strip;
  const QuadraticProblem problem = strip.Problem();
  const WeightSupports supports(strip.surface, strip.handles, 1);
  HandleSolver solver(problem, supports);
  ASSERT_TRUE(solver.Run(2, {}).ok());
  for (int h = 0; h < int(strip.handles.size()); ++h) {
    EXPECT_LE(solver.reports()[size_t(h)].stationarity, 1e-8) << h;
    const VectorXd whole = OverTheWhole(problem, h);
    // Both are within the square root of their gap.
    EXPECT_LT((solver.solutions().col(h) - whole).lpNorm<Eigen::Infinity>(), 2e-5) << h;
    EXPECT_GT((solver.solutions().col(h).array() == 0).count(), whole.size() / 4) << h;
  }
}

TEST(CoarseSurface, IsTheSurfaceInFewer) {
  const Strip strip;
  const CoarseSurface coarse = Coarsen(strip.surface, 100);
  EXPECT_GE(coarse.areas.size(), 100);
  EXPECT_LE(coarse.areas.size(), 3751 / 5);
  EXPECT_NEAR(coarse.areas.sum(), strip.surface.areas.sum(), 1e-9 * strip.surface.areas.sum());
  EXPECT_GT(coarse.areas.minCoeff(), 0);
  const VectorXd ones = VectorXd::Ones(coarse.areas.size());
  EXPECT_LT((coarse.laplacian * ones).lpNorm<Eigen::Infinity>(), 1e-12);
  const std::set<int> used(coarse.aggregate_of.begin(), coarse.aggregate_of.end());
  EXPECT_EQ(used.size(), size_t(coarse.areas.size()));
  // The energy of a smooth function is that of the surface, nearly.
  VectorXd fine(strip.mesh.num_vertices()), means = VectorXd::Zero(coarse.areas.size()),
                                            counts = means;
  for (int v = 0; v < strip.mesh.num_vertices(); ++v) {
    fine(v) = std::sin(0.05 * strip.mesh.shapes[0](v, 0));
    means(coarse.aggregate_of[size_t(v)]) += fine(v);
    counts(coarse.aggregate_of[size_t(v)]) += 1;
  }
  means.array() /= counts.array();
  const double energy = fine.dot(strip.surface.laplacian * fine);
  EXPECT_NEAR(means.dot(coarse.laplacian * means), energy, 0.15 * energy);
}

}  // namespace
}  // namespace limber::bake
