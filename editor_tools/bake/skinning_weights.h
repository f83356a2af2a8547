// Bounded biharmonic weights (Jacobson et al. 2011) over the welded surface.
#pragma once

#include "bake/bake.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

struct WeightsReport {
  // Before normalisation, the worst over handles: bounds and stationarity of the convex problem.
  double bound_violation = 0;
  double stationarity = 0;  // projected gradient, relative to the largest gradient of the start
  double sum_error = 0;     // largest |sum - 1| before rows were normalised
};

// V x H: for each handle min 1/2 w^T (L A^-1 L) w, 0 <= w <= 1, one at its own vertex, zero at the
// others'; rows then normalised to sum to one. handle_vertices: H distinct solve vertices.
// Every handle's problem is solved to its optimum (see bounded_quadratic.h) or the call fails with
// the handle's number and the residual. num_threads <= 0: one per core; the result has the same
// bits for any number. progress (may be empty) is told "weights" and the fraction of this stage, on
// the caller's thread only. Errors: kNoHandles, kInvalidArgument (handle vertices; "cancelled"),
// kDegenerate (not finite, not connected, no optimum), kInternal (out of memory).
Result<Eigen::MatrixXd> BoundedBiharmonicWeights(const geometry::SolveMesh& mesh,
                                                 std::span<const int> handle_vertices,
                                                 int num_threads, const ProgressCallback& progress,
                                                 WeightsReport* report);

}  // namespace limber::bake
