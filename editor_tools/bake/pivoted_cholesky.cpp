#include "bake/pivoted_cholesky.h"

#include "core/vector.h"

#include <algorithm>
#include <cmath>

namespace limber::bake {

Eigen::MatrixXd PivotedCholesky(Eigen::MatrixXd matrix, double cut) {
  const Eigen::Index size = matrix.rows();
  Eigen::VectorXd remaining = matrix.diagonal();
  const double threshold = size > 0 ? cut * std::max(remaining.maxCoeff(), 0.0) : 0;
  // Column j of `factor` is row j of F: contiguous, and the update below is one product.
  Eigen::MatrixXd factor(size, size);
  Vector<Eigen::Index> pivots;
  Eigen::Index rank = 0;
  for (; rank < size; ++rank) {
    Eigen::Index pivot = 0;
    const double largest = remaining.maxCoeff(&pivot);
    if (!(largest > threshold)) break;
    auto column = factor.col(rank);
    column = matrix.col(pivot);
    column.noalias() -= factor.leftCols(rank) * factor.row(pivot).head(rank).transpose();
    column /= std::sqrt(largest);
    for (const Eigen::Index earlier : pivots)
      column[earlier] = 0;  // but for rounding
    pivots.push_back(pivot);
    remaining -= column.cwiseAbs2();
    remaining[pivot] = 0;
  }
  return factor.leftCols(rank).transpose();
}

}  // namespace limber::bake
