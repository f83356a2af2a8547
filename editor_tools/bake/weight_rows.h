// What all kinds of skinning weights have in common: what they need, and rows made whole.
#pragma once

#include "core/status.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

// What weights are computed from: handle_vertices are one or more distinct solve vertices, the
// first shape is finite, triangles and bridges connect all. Errors: kNoHandles, kInvalidArgument,
// kDegenerate.
Status CheckWeightInput(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices);

// Rows that are all zero take the mean of their neighbours, ring by ring from the rows that have
// weights; then every row is scaled to sum to one. weights: V x H, >= 0, one row or more not zero;
// the mesh is connected.
void CompleteRows(const geometry::SolveMesh& mesh, Eigen::MatrixXd* weights);

// Weights that were painted on draw vertices, brought to the solve vertices (the mean of those that
// were welded) and completed: V x H. painted: D x H. Errors: kInvalidArgument (another number of
// vertices or handles than wanted, a weight that is negative or not finite), kDegenerate (a handle
// that no vertex follows); both name the handle by its column.
Result<Eigen::MatrixXd> CompletePaintedWeights(const geometry::SolveMesh& mesh, int num_handles,
                                               const Eigen::MatrixXd& painted);

}  // namespace limber::bake
