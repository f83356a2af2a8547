#include "solve/constraint_system.h"

#include <Eigen/Eigenvalues>

namespace limber {

ConstraintSystem ConstraintSystem::Create(Eigen::MatrixXd modes) {
  // Tables are single precision: an eigenvalue below this fraction of the largest is rounding, and
  // to divide by it would tear the character.
  constexpr double kCut = 1e-11;
  const Eigen::Index c = modes.rows();
  const Eigen::MatrixXd centred = modes.rowwise() - modes.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(centred * centred.transpose());
  const double threshold = kCut * eigen.eigenvalues().cwiseAbs().maxCoeff();
  Eigen::Index rank = 0;  // eigenvalues ascend: the last `rank` of them count
  while (rank < c && eigen.eigenvalues()[c - 1 - rank] > threshold)
    ++rank;
  ConstraintSystem system;
  system.root = eigen.eigenvectors().rightCols(rank) *
                eigen.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
  system.response = system.root * system.root.transpose();
  const Eigen::RowVectorXd mean = Eigen::RowVectorXd::Constant(c, 1.0 / static_cast<double>(c));
  system.translation = mean - (mean * modes) * modes.transpose() * system.response;
  system.modes = std::move(modes);
  return system;
}

}  // namespace limber
