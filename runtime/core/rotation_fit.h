// Procrustes: the rotation that fits best.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <cmath>

namespace limber {

// argmax over R in SO(k) of tr(R M): with M = U D V^T, R = V U^T, the direction of the smallest
// singular value flipped where that would reflect (Sorkine and Alexa 2007; eq. 22 of Wampler 2016).
// M = 0 gives the identity; ties are broken the same way on every run.
template <int K>
Eigen::Matrix<double, K, K> FitRotation(const Eigen::Matrix<double, K, K>& m) {
  using Matrix = Eigen::Matrix<double, K, K>;
  if constexpr (K == 2) {
    // tr(R M) = cos(a) (m00 + m11) + sin(a) (m01 - m10) for R = [cos -sin; sin cos].
    const double c = m(0, 0) + m(1, 1), s = m(0, 1) - m(1, 0);
    const double length = std::hypot(c, s);
    if (!(length > 0)) return Matrix::Identity();
    Matrix rotation;
    rotation << c / length, -s / length, s / length, c / length;
    return rotation;
  } else {
    const double largest = m.cwiseAbs().maxCoeff();
    if (!(largest > 0)) return Matrix::Identity();
    const Eigen::JacobiSVD<Matrix> svd(m / largest, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix v = svd.matrixV();
    if ((v * svd.matrixU().transpose()).determinant() < 0) v.col(K - 1) *= -1;
    return v * svd.matrixU().transpose();
  }
}

}  // namespace limber
