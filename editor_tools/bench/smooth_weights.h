// Skinning weights that cost nothing: smooth, a partition of unity, exactly one at their own
// vertex; they owe nothing to the weights of the bake.
#pragma once

#include "core/vector.h"

#include <Eigen/Core>

#include <algorithm>

namespace limber::bench {

// V x H: 1 / (distance^4 to the handle's vertex), normalised over handles.
inline Eigen::MatrixXd SmoothWeights(const Eigen::MatrixXd& points,
                                     const Vector<int>& handle_vertices) {
  Eigen::MatrixXd weights(points.rows(), static_cast<Eigen::Index>(handle_vertices.size()));
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    for (Eigen::Index h = 0; h < weights.cols(); ++h) {
      const double squared =
          (points.row(v) - points.row(handle_vertices[static_cast<size_t>(h)])).squaredNorm();
      weights(v, h) = 1 / std::max(squared * squared, 1e-40);
    }
    weights.row(v) /= weights.row(v).sum();
  }
  for (size_t h = 0; h < handle_vertices.size(); ++h) {
    weights.row(handle_vertices[h]).setZero();
    weights(handle_vertices[h], static_cast<Eigen::Index>(h)) = 1;
  }
  return weights;
}

}  // namespace limber::bench
