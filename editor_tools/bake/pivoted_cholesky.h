// A factor of a positive semi-definite matrix that may lack rank.
#pragma once

#include <Eigen/Core>

namespace limber::bake {

// F (rank x N) with F^T F = matrix up to remainders whose diagonal is at most
// cut * (largest diagonal of `matrix`). Diagonal pivoting, so the rank is the numerical one;
// each row is exactly zero in the columns that were pivots of earlier rows.
// Only the lower or the upper half need be exact; both are read.
Eigen::MatrixXd PivotedCholesky(Eigen::MatrixXd matrix, double cut);

}  // namespace limber::bake
