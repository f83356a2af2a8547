#include "bake/heat_weights.h"

#include "bake/quadratic_problem.h"
#include "bake/skinning_weights.h"
#include "bake/weight_rows.h"
#include "core/vector.h"
#include "geometry/geodesic.h"
#include "geometry/robust_laplacian.h"
#include "linear/supernodal_cholesky.h"
#include "threads/parallel_for.h"

#include <array>
#include <limits>

namespace limber::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of each vertex, the handle at the shortest distance; the first of several.
struct Nearest {
  Vector<int> handle;
  VectorXd distance;
};

Nearest FindNearest(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices,
                    int num_threads) {
  const geometry::EdgeGraph graph(mesh);
  const auto num_handles = static_cast<int>(handle_vertices.size());
  Vector<VectorXd> distances(handle_vertices.size());
  threads::ParallelFor(num_handles, num_threads, [&](int h) {
    const auto index = static_cast<size_t>(h);
    distances[index] = graph.Distances(std::array{handle_vertices[index]});
  });
  const auto num_vertices = static_cast<Index>(mesh.num_vertices());
  Nearest nearest{Vector<int>(static_cast<size_t>(num_vertices), 0), distances[0]};
  for (int h = 1; h < num_handles; ++h) {
    const VectorXd& distance = distances[static_cast<size_t>(h)];
    for (Index v = 0; v < num_vertices; ++v) {
      if (distance(v) >= nearest.distance(v)) continue;
      nearest.distance(v) = distance(v);
      nearest.handle[static_cast<size_t>(v)] = h;
    }
  }
  return nearest;
}

}  // namespace

Result<MatrixXd> HeatWeights(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices,
                             int num_threads, const ProgressCallback& progress) {
  LIMBER_RETURN_IF_ERROR(CheckWeightInput(mesh, handle_vertices));
  if (progress && !progress("weights", 0)) return Error(StatusCode::kInvalidArgument, "cancelled");
  const Nearest nearest = FindNearest(mesh, handle_vertices, num_threads);
  const geometry::RobustLaplacian surface = geometry::MakeRobustLaplacian(mesh);
  // The same split as for the biharmonic form, of another one.
  const QuadraticProblem problem = SplitOffHandles(surface.laplacian, handle_vertices);
  const auto num_free = static_cast<Index>(problem.free_vertices.size());
  VectorXd warmth(num_free);
  for (Index i = 0; i < num_free; ++i) {
    const int vertex = problem.free_vertices[static_cast<size_t>(i)];
    const double squared = nearest.distance(vertex) * nearest.distance(vertex);
    // Vertices in one place with a handle are as warm as it gets.
    constexpr double kWarmest = 1e12;
    warmth(i) = std::min(surface.areas(vertex) / squared, kWarmest);
  }
  const linear::SupernodalCholesky cholesky(problem.Q);
  linear::SupernodalCholesky::Factor factor;
  MatrixXd weights = MatrixXd::Zero(mesh.num_vertices(), problem.c.cols());
  for (Index h = 0; h < problem.c.cols(); ++h) {
    VectorXd w = -problem.c.col(h);
    for (Index i = 0; i < num_free; ++i) {
      const auto vertex = static_cast<size_t>(problem.free_vertices[static_cast<size_t>(i)]);
      if (nearest.handle[vertex] == h) w(i) += warmth(i);
    }
    h == 0 ? cholesky.FactoriseAndSolve(1, warmth.data(), &factor, w.data())
           : cholesky.Solve(&factor, w.data());
    weights(problem.free_vertices, h) = w.cwiseMax(0).cwiseMin(1);
    weights(handle_vertices[static_cast<size_t>(h)], h) = 1;
  }
  if (!factor.definite || !weights.allFinite()) {
    return Error(StatusCode::kDegenerate,
                 "skinning weights: no heat flows on this mesh; check it for degenerate triangles");
  }
  CompleteRows(mesh, &weights);
  return weights;
}

}  // namespace limber::bake
