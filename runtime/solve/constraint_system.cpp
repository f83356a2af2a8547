#include "solve/constraint_system.h"

#include "core/aligned_vector.h"
#include "core/vector.h"

#include <Eigen/Cholesky>
#include <Eigen/Jacobi>

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

// Tables are single precision: an eigenvalue below this fraction of the largest is rounding, and
// to divide by it would tear the character.
constexpr double kCut = 1e-11;
constexpr int kMaxSweeps = 30;  // of Jacobi rotations; six are usual

// One sweep over all pairs; returns the largest entry off the diagonal before it.
double JacobiSweep(Eigen::Map<Eigen::MatrixXd>* matrix, Eigen::Map<Eigen::MatrixXd>* vectors) {
  double largest = 0;
  for (Eigen::Index p = 0; p < matrix->rows(); ++p) {
    for (Eigen::Index q = p + 1; q < matrix->rows(); ++q) {
      largest = std::max(largest, std::abs((*matrix)(p, q)));
      Eigen::JacobiRotation<double> rotation;
      if (!rotation.makeJacobi(*matrix, p, q)) continue;
      matrix->applyOnTheLeft(p, q, rotation.adjoint());
      matrix->applyOnTheRight(p, q, rotation);
      vectors->applyOnTheRight(p, q, rotation);
    }
  }
  return largest;
}

}  // namespace

ConstraintSystem::ConstraintSystem(size_t max_rows, size_t num_modes)
    : num_modes_(static_cast<Eigen::Index>(num_modes)),
      modes_(max_rows * num_modes),
      response_(max_rows * max_rows),
      root_(response_),
      translation_(max_rows),
      gram_(response_),
      reflector_(max_rows),
      reduced_(response_),
      factor_(response_),
      reduced_root_(response_) {}

size_t ConstraintSystem::bytes() const {
  return BytesOf(modes_, response_, root_, translation_, gram_, reflector_, reduced_, factor_,
                 reduced_root_);
}

void ConstraintSystem::Compute(std::span<const ConstraintRow> rows) {
  size_ = rows.size();
  FillGram(rows);
  Reflect(rows);
  if (!InvertByCholesky()) InvertByEigenvalues();
  ReflectBack();
  FillTranslation(rows);
}

void ConstraintSystem::FillGram(std::span<const ConstraintRow> rows) {
  Square gram(gram_.data(), Rows(), Rows());
  const auto row_of = [&](size_t i) {
    return Eigen::Map<const Eigen::VectorXd>(rows[i].modes, num_modes_);
  };
  for (size_t i = 0; i < size_; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    std::copy_n(rows[i].modes, num_modes_, modes_.begin() + at * num_modes_);
    for (size_t j = 0; j <= i; ++j) {
      const auto other = static_cast<Eigen::Index>(j);
      gram(at, other) = gram(other, at) = row_of(i).dot(row_of(j));
    }
    gram(at, at) += rows[i].compliance;
  }
}

// H G H with the Householder reflection H that maps a onto the first axis; what is left without
// the first row and column is G across a.
void ConstraintSystem::Reflect(std::span<const ConstraintRow> rows) {
  double norm = 0;
  for (const ConstraintRow& row : rows)
    norm += row.translation * row.translation;
  norm = std::sqrt(norm);
  for (size_t i = 0; i < size_; ++i)
    reflector_[i] = rows[i].translation / norm;
  reflector_[0] += reflector_[0] < 0 ? -1 : 1;
  const Square gram(gram_.data(), Rows(), Rows());
  const Eigen::Map<const Eigen::VectorXd> v(reflector_.data(), Rows());
  reflector_scale_ = 2 / v.squaredNorm();
  // H G H = G - v u^T - u v^T, u = beta G v - beta^2/2 (v^T G v) v; u is left in translation_.
  double inner = 0;
  for (size_t i = 0; i < size_; ++i) {
    translation_[i] = reflector_scale_ * gram.col(static_cast<Eigen::Index>(i)).dot(v);
    inner += reflector_[i] * translation_[i];
  }
  for (size_t i = 0; i < size_; ++i)
    translation_[i] -= 0.5 * reflector_scale_ * inner * reflector_[i];
  Square reduced(reduced_.data(), Rows() - 1, Rows() - 1);
  for (Eigen::Index j = 1; j < Rows(); ++j) {
    for (Eigen::Index i = 1; i < Rows(); ++i) {
      const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j);
      reduced(i - 1, j - 1) =
          gram(i, j) - reflector_[a] * translation_[b] - translation_[a] * reflector_[b];
    }
  }
}

// The root of the inverse is L^-T. False where the matrix is as good as singular.
bool ConstraintSystem::InvertByCholesky() {
  const Eigen::Index size = Rows() - 1;
  rank_ = static_cast<size_t>(size);
  if (size == 0) return true;
  const Square reduced(reduced_.data(), size, size);
  Square factor(factor_.data(), size, size), root(reduced_root_.data(), size, size);
  factor = reduced;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(factor);
  if (cholesky.info() != Eigen::Success) return false;
  const double smallest = factor.diagonal().minCoeff();
  if (!(smallest * smallest > kCut * reduced.diagonal().maxCoeff())) return false;
  // Column j of L^-T, an upper triangle: back substitution from row j up.
  root.setZero();
  for (Eigen::Index j = 0; j < size; ++j) {
    for (Eigen::Index i = j; i >= 0; --i) {
      double sum = i == j ? 1 : 0;
      for (Eigen::Index m = i + 1; m <= j; ++m)
        sum -= factor(m, i) * root(m, j);
      root(i, j) = sum / factor(i, i);
    }
  }
  return true;
}

void ConstraintSystem::InvertByEigenvalues() {
  const Eigen::Index size = Rows() - 1;
  Square matrix(reduced_.data(), size, size), vectors(factor_.data(), size, size);
  vectors.setIdentity();
  const double scale = matrix.diagonal().cwiseAbs().maxCoeff();
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    if (!(JacobiSweep(&matrix, &vectors) > 1e-16 * scale)) break;
  }
  const double threshold = kCut * matrix.diagonal().cwiseAbs().maxCoeff();
  rank_ = 0;
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!(matrix(i, i) > threshold)) continue;
    Square(reduced_root_.data(), size, size).col(static_cast<Eigen::Index>(rank_++)) =
        vectors.col(i) / std::sqrt(matrix(i, i));
  }
}

void ConstraintSystem::ReflectBack() {
  const auto rank = static_cast<Eigen::Index>(rank_);
  Square root(root_.data(), Rows(), rank);
  const Eigen::Map<const Eigen::VectorXd> v(reflector_.data(), Rows());
  for (Eigen::Index j = 0; j < rank; ++j) {
    const double* from = reduced_root_.data() + j * (Rows() - 1);
    double along = 0;
    for (Eigen::Index i = 1; i < Rows(); ++i)
      along += v[i] * from[i - 1];
    for (Eigen::Index i = 0; i < Rows(); ++i)
      root(i, j) = (i == 0 ? 0 : from[i - 1]) - reflector_scale_ * along * v[i];
  }
  Square response(response_.data(), Rows(), Rows());
  for (Eigen::Index i = 0; i < Rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j)
      response(i, j) = response(j, i) = root.row(i).dot(root.row(j));
  }
}

// w = a^T (1 - G W) / a^T a.
void ConstraintSystem::FillTranslation(std::span<const ConstraintRow> rows) {
  const Square gram(gram_.data(), Rows(), Rows()), response(response_.data(), Rows(), Rows());
  double squared = 0;
  for (const ConstraintRow& row : rows)
    squared += row.translation * row.translation;
  Vector<double>& reached = reflector_;  // a^T G
  for (Eigen::Index j = 0; j < Rows(); ++j) {
    double sum = 0;
    for (size_t i = 0; i < size_; ++i)
      sum += rows[i].translation * gram(static_cast<Eigen::Index>(i), j);
    reached[static_cast<size_t>(j)] = sum;
  }
  const Eigen::Map<const Eigen::VectorXd> row(reached.data(), Rows());
  for (size_t j = 0; j < size_; ++j) {
    const double met = row.dot(response.col(static_cast<Eigen::Index>(j)));
    translation_[j] = (rows[j].translation - met) / squared;
  }
}

}  // namespace limber
