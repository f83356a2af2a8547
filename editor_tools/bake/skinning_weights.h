// Bounded biharmonic weights (Jacobson et al. 2011) over the welded surface.
#pragma once

#include <Eigen/Core>
#include <span>

#include "bake/bake.h"
#include "geometry/solve_mesh.h"

namespace limber::bake {

struct WeightsReport {
  // Before normalisation, the worst over handles: bounds and stationarity of the convex problem.
  double bound_violation = 0;
  double stationarity = 0;     // projected gradient, relative to the largest gradient of the start
  double sum_error = 0;        // largest |sum - 1| before rows were normalised
};

// V x H: for each handle min 1/2 w^T (L A^-1 L) w, 0 <= w <= 1, one at its own vertex, zero at the
// others'; rows then normalised to sum to one. handle_vertices: H distinct solve vertices.
Result<Eigen::MatrixXd> BoundedBiharmonicWeights(const geometry::SolveMesh& mesh,
                                                 std::span<const int> handle_vertices,
                                                 int num_threads, const ProgressCallback& progress,
                                                 WeightsReport* report);

}  // namespace limber::bake
