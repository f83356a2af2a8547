// Bounded biharmonic weights (Jacobson et al. 2011) over the welded surface.
#pragma once

#include "bake/progress.h"
#include "core/status.h"
#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

struct HandleOptimality {
  int iterations = 0;
  bool converged = true;  // false: rounding stopped it short of the optimum, see below by how much
  // Largest entry of w - clamp(w - gradient, 0, 1), the gradient in units of the pull of the handle
  // on its neighbours: bounds and stationarity at once.
  double stationarity = 0;
  double complementarity = 0;  // duality gap, relative to the energy
};

inline constexpr double kUsableStationarity = 1e-3;

struct WeightsReport {
  Vector<HandleOptimality> handles;  // H; empty where there is only one
  // The worst over handles, before rows were normalised.
  double bound_violation = 0;
  double stationarity = 0;
  double complementarity = 0;
  double sum_error = 0;  // largest |sum - 1| before rows were normalised
};

// V x H: for each handle min 1/2 w^T (L A^-1 L) w, 0 <= w <= 1, one at its own vertex, zero at the
// others'; rows then normalised to sum to one. handle_vertices: H distinct solve vertices.
// Every handle's problem is solved to its optimum (see bounded_quadratic.h). On meshes so badly
// shaped that rounding stops it before, what was reached is good enough up to kUsableStationarity,
// and the report says so; beyond, the call fails with the handle's number and the residual.
// num_threads <= 0: one per core; the result has the same bits for any number. progress (may be
// empty) is told "weights" and the fraction of this stage, on the caller's thread only. Errors:
// kNoHandles, kInvalidArgument (handle vertices; "cancelled"), kDegenerate (not finite, not
// connected, no optimum), kInternal (out of memory).
Result<Eigen::MatrixXd> BoundedBiharmonicWeights(const geometry::SolveMesh& mesh,
                                                 std::span<const int> handle_vertices,
                                                 int num_threads, const ProgressCallback& progress,
                                                 WeightsReport* report);

}  // namespace limber::bake
