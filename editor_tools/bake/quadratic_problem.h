// Quadratic forms on a surface, with what the handles fix taken out.
#pragma once

#include "core/vector.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <span>

namespace limber::bake {

// L A^-1 L for areas A relative to their mean, so that it knows no unit of length. V x V.
Eigen::SparseMatrix<double> BiharmonicForm(const Eigen::SparseMatrix<double>& laplacian,
                                           const Eigen::VectorXd& areas);

// min 1/2 x^T Q x + c_h^T x, for each handle h.
struct QuadraticProblem {
  Vector<int> free_vertices;      // those that no handle has; rows of what follows
  Eigen::SparseMatrix<double> Q;  // free x free
  Eigen::MatrixXd c;              // free x H: the pull of each handle's one
};

// The form Q's problem; handles that share a vertex pull together at it.
QuadraticProblem SplitOffHandles(const Eigen::SparseMatrix<double>& Q,
                                 std::span<const int> handle_vertices);

}  // namespace limber::bake
