#include "bake/weight_supports.h"

#include "bake/bounded_quadratic.h"
#include "bake/quadratic_problem.h"
#include "core/vector.h"
#include "threads/parallel_for.h"

#include <utility>

namespace limber::bake {
namespace {

using Eigen::SparseMatrix;
using Eigen::VectorXd;

constexpr int kFewestAggregates = 300;
constexpr double kReached = 1e-5;  // below this, a coarse weight is the solver's rounding

}  // namespace

WeightSupports::WeightSupports(const geometry::RobustLaplacian& surface,
                               std::span<const int> handle_vertices, int num_threads)
    : coarse_(Coarsen(surface, kFewestAggregates)) {
  const auto num_handles = static_cast<int>(handle_vertices.size());
  is_reached_.setConstant(coarse_.areas.size(), num_handles, true);
  if (coarse_.areas.size() == surface.areas.size()) return;
  Vector<int> aggregates;  // of the handles
  for (const int vertex : handle_vertices)
    aggregates.push_back(coarse_.aggregate_of[static_cast<size_t>(vertex)]);
  const QuadraticProblem problem =
      SplitOffHandles(BiharmonicForm(coarse_.laplacian, coarse_.areas), aggregates);
  const BoundedQuadratic solver(problem.Q);
  threads::ParallelFor(num_handles, num_threads, [&](int h) {
    VectorXd x;
    const BoundedQuadraticReport report = solver.Solve(
        problem.c.col(h), [] { return true; }, &x);
    if (!report.converged) return;
    for (size_t i = 0; i < problem.free_vertices.size(); ++i)
      is_reached_(problem.free_vertices[i], h) = x(static_cast<Eigen::Index>(i)) > kReached;
    for (const int aggregate : aggregates)
      is_reached_(aggregate, h) = aggregate == aggregates[static_cast<size_t>(h)];
  });
}

Vector<bool> WeightSupports::Around(int handle, int rings) const {
  Eigen::Matrix<bool, Eigen::Dynamic, 1> is_in = is_reached_.col(handle);
  for (int ring = 0; ring < rings; ++ring) {
    const auto before = is_in;
    for (int aggregate = 0; aggregate < coarse_.touching.outerSize(); ++aggregate) {
      if (!before(aggregate)) continue;
      for (SparseMatrix<double>::InnerIterator it(coarse_.touching, aggregate); it; ++it)
        is_in(it.row()) = true;
    }
  }
  Vector<bool> vertices;
  vertices.reserve(coarse_.aggregate_of.size());
  for (const int aggregate : coarse_.aggregate_of)
    vertices.push_back(is_in(aggregate));
  return vertices;
}

}  // namespace limber::bake
