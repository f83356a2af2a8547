#include "bake/mode_basis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace limber::bake {
namespace {

// Directions whose root-mean-square motion is below 3e-7 of the largest one's are noise: to use
// them would need transforms that single precision cannot carry.
constexpr double kMotionCut = 1e-13;
// Lost motion of the exact fields below this fraction of theirs stays lost.
constexpr double kLossCut = 1e-10;
// Below this fraction of the largest energy a mode counts as free of energy.
constexpr double kEnergyCut = 1e-13;

// The Gram matrix of the columns, only as fast as half of it needs to be.
Eigen::MatrixXd Gram(const Eigen::MatrixXd& matrix) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(matrix.cols(), matrix.cols());
  gram.selfadjointView<Eigen::Lower>().rankUpdate(matrix.transpose());
  return gram.selfadjointView<Eigen::Lower>();
}

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

Eigen::MatrixXd ExampleTransforms(Eigen::Index num_handles, Eigen::Index num_shapes,
                                  Eigen::Index k) {
  Eigen::MatrixXd transforms =
      Eigen::MatrixXd::Zero(num_handles * num_shapes * (k + 1), num_shapes * k);
  for (Eigen::Index h = 0; h < num_handles; ++h) {
    for (Eigen::Index s = 0; s < num_shapes; ++s) {
      transforms.block((h * num_shapes + s) * (k + 1), s * k, k, k).setIdentity();
    }
  }
  return transforms;
}

namespace {

// Directions that move vertices, scaled to equal motion: in them energies are physical, and no
// digits are lost on directions that are nearly dependent.
Result<ModeBasis> MovingDirections(const Eigen::MatrixXd& skinning) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> motion(Gram(skinning));
  if (motion.info() != Eigen::Success) {
    return Error(StatusCode::kInternal, "reduce: the motion eigenproblem did not converge");
  }
  const Eigen::VectorXd& motions = motion.eigenvalues();
  const Eigen::Index n = motions.size();
  Eigen::Index first = 0;
  while (first < n && motions[first] <= kMotionCut * motions[n - 1]) ++first;
  const Eigen::Index kept = n - first;
  ModeBasis moving;
  moving.transforms = motion.eigenvectors().rightCols(kept) *
                      motions.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  moving.shapes = skinning * moving.transforms;
  return moving;
}

// Appends what of the exact fields the cut above has lost: a millionth of their motion, but on a
// fine mesh a thousandth of their energy's root, which the solver would see.
void KeepExact(const Eigen::MatrixXd& skinning, const Eigen::MatrixXd& exact, ModeBasis* moving) {
  const Eigen::MatrixXd wanted = skinning * exact;
  const Eigen::LLT<Eigen::MatrixXd> gram(Gram(moving->shapes));
  const Eigen::MatrixXd reached = gram.solve(moving->shapes.transpose() * wanted);
  const Eigen::MatrixXd lost = wanted - moving->shapes * reached;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(lost);
  const double threshold = kLossCut * wanted.colwise().norm().maxCoeff();
  Eigen::Index rank = 0;
  const Eigen::Index most = std::min(lost.rows(), lost.cols());
  while (rank < most && std::abs(qr.matrixQR()(rank, rank)) > threshold) ++rank;
  if (rank == 0) return;
  const Eigen::MatrixXd directions =
      ((exact - moving->transforms * reached) * qr.colsPermutation()).leftCols(rank);
  const auto upper = qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>();
  const Eigen::Index before = moving->transforms.cols();
  moving->transforms.conservativeResize(Eigen::NoChange, before + rank);
  moving->transforms.rightCols(rank) = upper.solve<Eigen::OnTheRight>(directions);
  moving->shapes.conservativeResize(Eigen::NoChange, before + rank);
  moving->shapes.rightCols(rank) =
      qr.householderQ() * Eigen::MatrixXd::Identity(lost.rows(), rank);
}

}  // namespace

Result<ModeBasis> ComputeModeBasis(const Eigen::MatrixXd& skinning,
                                   const Eigen::SparseMatrix<double>& laplacian,
                                   const Eigen::MatrixXd& exact) {
  Result<ModeBasis> moving = MovingDirections(skinning);
  if (!moving.ok()) return moving.status();
  KeepExact(skinning, exact, &*moving);
  const Eigen::MatrixXd& fields = moving->shapes;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> energy(fields.transpose() *
                                                              (laplacian * fields));
  if (energy.info() != Eigen::Success) {
    return Error(StatusCode::kInternal, "reduce: the energy eigenproblem did not converge");
  }
  const Eigen::VectorXd& energies = energy.eigenvalues();
  const Eigen::Index num_modes = energies.size() - 1;  // all but the translation
  if (num_modes > 0 && energies[1] <= kEnergyCut * energies[num_modes]) {
    return Error(StatusCode::kDegenerate,
                 "reduce: a part of the character hangs on nothing (energy %g of %g); check for "
                 "loose vertices",
                 energies[1], energies[num_modes]);
  }
  const Eigen::MatrixXd whiten =
      energy.eigenvectors().rightCols(num_modes) *
      energies.tail(num_modes).cwiseSqrt().cwiseInverse().asDiagonal();
  return ModeBasis{moving->transforms * whiten, fields * whiten};
}

}  // namespace limber::bake
