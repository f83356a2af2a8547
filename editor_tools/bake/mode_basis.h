// Whitened modes of a linear-blend-skinning space: the coordinates that the runtime solves in.
#pragma once

#include "core/status.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace limber::bake {

// Columns of `transforms` (Phi_1, n x r) are skinning transforms, columns of `shapes` (M Phi_1,
// V x r) the displacement fields that they make; shapes^T L shapes = I. Directions of transform
// space that move no vertex are left out (the pseudo-inverse of the singular L~ is meant), and so
// is the one direction without energy, the translation of everything.
struct ModeBasis {
  Eigen::MatrixXd transforms;
  Eigen::MatrixXd shapes;
};

// skinning: M of eq. 6, V x n. laplacian: L of eq. 14, V x V, connected.
// Errors: kDegenerate when more than one direction moves vertices without energy (a part that
// hangs on nothing), kInternal when an eigen-decomposition fails. num_threads <= 0: one per core;
// the bits are the same for any number.
Result<ModeBasis> ComputeModeBasis(const Eigen::MatrixXd& skinning,
                                   const Eigen::SparseMatrix<double>& laplacian, int num_threads);

// `shape` (V x k) as nearly as the modes and a translation reach it, nearest in energy: within a
// millionth of its size if it is an example shape.
Eigen::MatrixXd ReachableShape(const ModeBasis& basis, const Eigen::SparseMatrix<double>& laplacian,
                               const Eigen::MatrixXd& shape);

// M of eq. 6 for the shapes given (each V x k) and weights (V x H): V x H*S*(k+1), columns
// (h, s, i), i = 0..k with the constant 1 last.
Eigen::MatrixXd SkinningMatrix(const Eigen::MatrixXd& weights, const Eigen::MatrixXd* first_shape,
                               int num_shapes);

}  // namespace limber::bake
