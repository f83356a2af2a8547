// Sparse Cholesky factors of several matrices of one pattern at once, one matrix a SIMD lane: what
// a sparse factorisation spends on finding its numbers is spent once for all of them, and the
// numbers lie side by side.
//
// Left-looking over supernodes (columns of L with one pattern; small ones are merged), in the
// better of two orders. Lanes never meet: a lane's bits do not depend on the others, nor on how
// many there are.
#pragma once

#include "bake/cholesky_kernels/cholesky_kernels.h"
#include "bake/large_buffer.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <array>
#include <vector>

namespace limber::bake {

class LaneCholesky {
 public:
  // Lanes that Factorise takes: these numbers only.
  static constexpr int kFew = 4, kMany = 8;

  // Q: symmetric, n x n, given whole. Only its pattern's analysis costs more than linear time.
  explicit LaneCholesky(const Eigen::SparseMatrix<double>& Q,
                        const CholeskyKernels& kernels = ChooseCholeskyKernels());

  int size() const { return static_cast<int>(new_of_old_.size()); }

  // Numbers that a factor of one lane takes.
  size_t num_values() const { return num_values_; }

  // L of some lanes' matrices, and what solving needs beside it. One may be used again and again.
  struct Factor {
    int lanes = 0;
    // Whether each lane's matrix is positive definite; else its numbers mean nothing.
    std::array<bool, kMany> definite{};
    LargeBuffer values;               // [num_values][lanes]
    std::vector<double> diagonal, x;  // [n][lanes], in the order of the elimination
  };

  // In lane l: L L^T = scales[l] Q + diag(diagonal[:][l]); diagonal: [n][lanes]. x: [n][lanes], in
  // the right sides, out the solutions, for half of what Solve costs.
  void FactoriseAndSolve(const double* scales, const double* diagonal, int lanes, Factor* factor,
                         double* x) const;

  // x: [n][lanes], in the right sides, out the solutions.
  void Solve(Factor* factor, double* x) const;

 private:
  struct Supernode {
    int first = 0, width = 0;  // its columns
    size_t rows = 0;           // where its row numbers begin in rows_: its own columns, then others
    int num_rows = 0;
    size_t values = 0;  // [num_rows][width] from here
  };

  struct Entry {
    int row = 0;  // of the permuted lower triangle
    double value = 0;
  };

  struct Pending;

  double* Row(const Supernode& supernode, int row, Factor* factor) const;
  PanelView Panel(const Supernode& supernode, const Factor& factor) const;
  void Permute(const double* from, int lanes, std::vector<double>* to) const;
  void Begin(const Supernode& to, const std::vector<int>& local, const double* scales,
             Factor* factor) const;
  void List(size_t which, int rows_done, Pending* pending) const;
  void TakeProducts(size_t target, const std::vector<int>& local, Pending* pending,
                    Factor* factor) const;
  void SolveBackward(Factor* factor, double* x) const;
  void FindSupernodes(const std::vector<int>& parents, std::vector<std::vector<int>> patterns);

  const CholeskyKernels& kernels_;
  std::vector<int> new_of_old_;
  std::vector<size_t> entries_begin_;  // [n + 1]: of each permuted column
  std::vector<Entry> entries_;
  std::vector<Supernode> supernodes_;
  std::vector<int> supernode_of_;  // [n]
  std::vector<int> rows_;
  size_t num_values_ = 0;
};

}  // namespace limber::bake
