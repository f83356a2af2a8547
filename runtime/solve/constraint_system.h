// Elimination of the transforms: pinned points against whitened modes.
//
// With whitened modes the energy is 1/2 |z - b|^2, and pinned points ask 1 t + C z = X. The
// minimum:
//     y = W (X - C b),   z = b + C^T y,   t = w (X - C b),   1/2 |z - b|^2 = 1/2 tr(d^T W d),
// d = X - C b, where W is the pseudo-inverse of C C^T with translations projected out. Pins that
// cannot move independently are met in the least-squares sense. Costs O(c^3) for c pins, whatever
// the mesh's size, so pins can change while a game runs.
#pragma once

#include <Eigen/Core>

namespace limber {

struct ConstraintSystem {
  Eigen::MatrixXd modes;           // C: c x r
  Eigen::MatrixXd response;        // W: c x c, symmetric positive semi-definite, W 1 = 0
  Eigen::MatrixXd root;            // L: c x q with W = L L^T, q <= c - 1 its rank
  Eigen::RowVectorXd translation;  // w: 1 x c, sums to one

  // modes: rows of the pinned points, without the translation's column.
  static ConstraintSystem Create(Eigen::MatrixXd modes);
};

}  // namespace limber
