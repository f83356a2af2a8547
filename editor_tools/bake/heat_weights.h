// Weights for a preview: each handle warms what is nearest to it, and the heat spreads.
#pragma once

#include "bake/progress.h"
#include "core/status.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

// V x H: for each handle the solution of L w + A / d^2 (w - p) = 0, where p is one at the vertices
// that the handle is nearest to and zero elsewhere, and d the distance to the nearest handle along
// edges (Baran and Popovic 2007, Automatic rigging and animation of 3D characters); one at its own
// vertex, zero at the others'. Within 0 and 1 and summing to one as they are, on any mesh, since L
// has no positive entry beside its diagonal. One factorisation serves all handles. They fall off
// faster than bounded biharmonic weights and are less smooth at the handles.
// Input, errors and threads as for BoundedBiharmonicWeights.
Result<Eigen::MatrixXd> HeatWeights(const geometry::SolveMesh& mesh,
                                    std::span<const int> handle_vertices, int num_threads,
                                    const ProgressCallback& progress);

}  // namespace limber::bake
