#include "bake/mode_basis.h"

#include "linear/dense_products.h"

#include <Eigen/Eigenvalues>

namespace limber::bake {
namespace {

// Directions whose root-mean-square motion is below 3e-7 of the largest one's are noise: to use
// them would need transforms that single precision cannot carry.
constexpr double kMotionCut = 1e-13;
// Below this fraction of the largest energy a mode counts as free of energy.
constexpr double kEnergyCut = 1e-13;

}  // namespace

Eigen::MatrixXd SkinningMatrix(const Eigen::MatrixXd& weights, const Eigen::MatrixXd* first_shape,
                               int num_shapes) {
  const Eigen::Index num_vertices = weights.rows(), num_handles = weights.cols();
  const Eigen::Index k = first_shape->cols();
  Eigen::MatrixXd skinning(num_vertices, num_handles * num_shapes * (k + 1));
  Eigen::Index column = 0;
  for (Eigen::Index h = 0; h < num_handles; ++h) {
    for (int s = 0; s < num_shapes; ++s) {
      for (Eigen::Index i = 0; i < k; ++i) {
        skinning.col(column++) = weights.col(h).cwiseProduct(first_shape[s].col(i));
      }
      skinning.col(column++) = weights.col(h);
    }
  }
  return skinning;
}

Result<ModeBasis> ComputeModeBasis(const Eigen::MatrixXd& skinning,
                                   const Eigen::SparseMatrix<double>& laplacian, int num_threads) {
  // First the directions that move vertices, scaled to equal motion: in them energies are
  // physical, and no digits are lost on directions that are nearly dependent.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> motion(
      linear::SymmetricProduct(skinning, skinning, num_threads));
  if (motion.info() != Eigen::Success) {
    return Error(StatusCode::kInternal, "reduce: the motion eigenproblem did not converge");
  }
  const Eigen::VectorXd& motions = motion.eigenvalues();
  const Eigen::Index n = motions.size();
  Eigen::Index first = 0;
  while (first < n && motions[first] <= kMotionCut * motions[n - 1])
    ++first;
  const Eigen::Index kept = n - first;
  const Eigen::MatrixXd moving = motion.eigenvectors().rightCols(kept) *
                                 motions.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd fields = linear::Product(skinning, moving, num_threads);
  const Eigen::MatrixXd forces = linear::Product(laplacian, fields, num_threads);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> energy(
      linear::SymmetricProduct(fields, forces, num_threads));
  if (energy.info() != Eigen::Success) {
    return Error(StatusCode::kInternal, "reduce: the energy eigenproblem did not converge");
  }
  const Eigen::VectorXd& energies = energy.eigenvalues();
  const Eigen::Index num_modes = kept - 1;  // all but the translation
  if (num_modes > 0 && energies[1] <= kEnergyCut * energies[kept - 1]) {
    return Error(StatusCode::kDegenerate,
                 "reduce: a part of the character hangs on nothing (energy %g of %g); check for "
                 "loose vertices",
                 energies[1], energies[kept - 1]);
  }
  const Eigen::MatrixXd whiten = energy.eigenvectors().rightCols(num_modes) *
                                 energies.tail(num_modes).cwiseSqrt().cwiseInverse().asDiagonal();
  return ModeBasis{moving * whiten, linear::Product(fields, whiten, num_threads)};
}

Eigen::MatrixXd ReachableShape(const ModeBasis& basis, const Eigen::SparseMatrix<double>& laplacian,
                               const Eigen::MatrixXd& shape) {
  const Eigen::MatrixXd modes = basis.shapes.transpose() * (laplacian * shape);
  Eigen::MatrixXd reached = basis.shapes * modes;
  const Eigen::RowVectorXd shift = (shape - reached).colwise().mean();
  reached.rowwise() += shift;
  return reached;
}

}  // namespace limber::bake
