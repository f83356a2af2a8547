// Sparse Cholesky factorisation of many matrices that share one pattern.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace limber::geometry {

// What follows from the pattern alone; immutable, shared by any number of factors and threads.
class CholeskyPattern {
 public:
  // A: symmetric, given whole, diagonal entries present.
  explicit CholeskyPattern(const Eigen::SparseMatrix<double>& A) : matrix_(A) {}

 private:
  friend class CholeskyFactor;
  Eigen::SparseMatrix<double> matrix_;
};

// The numbers of one factorisation; belongs to one thread at a time.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const CholeskyPattern& pattern) {
    solver_.analyzePattern(pattern.matrix_);
  }

  // Factors A + diag(extra). Returns false where it is not positive definite or not finite.
  bool Factorise(const Eigen::SparseMatrix<double>& A, const Eigen::VectorXd& extra) {
    Eigen::SparseMatrix<double> sum = A;
    for (Eigen::Index i = 0; i < extra.size(); ++i)
      sum.coeffRef(i, i) += extra(i);
    solver_.factorize(sum);
    return solver_.info() == Eigen::Success;
  }

  Eigen::VectorXd Solve(const Eigen::VectorXd& b) const { return solver_.solve(b); }

 private:
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace limber::geometry
