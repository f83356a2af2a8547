// Sparse Cholesky factors of several matrices of one pattern at once, one matrix a SIMD lane: what
// a sparse factorisation spends on finding its numbers is spent once for all of them, and the
// numbers lie side by side.
//
// Left-looking over supernodes (columns of L with one pattern; small ones are merged), in the
// better of two orders. Lanes never meet: a lane's bits do not depend on the others, nor on how
// many there are.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace limber::bake {

class LaneCholesky {
 public:
  // Lanes that Factorise takes: these numbers only.
  static constexpr int kFew = 4, kMany = 8;

  // Q: symmetric, n x n, given whole. Only its pattern's analysis costs more than linear time.
  explicit LaneCholesky(const Eigen::SparseMatrix<double>& Q);

  int size() const { return static_cast<int>(new_of_old_.size()); }

  // Numbers that a factor of one lane takes.
  size_t num_values() const { return num_values_; }

  // In lane l: L L^T = scales[l] Q + diag(diagonal[:][l]); diagonal: [n][lanes]; values:
  // [num_values][lanes], resized. definite[l]: whether lane l's matrix is positive definite; else
  // its factor is not one.
  void Factorise(const double* scales, const double* diagonal, int lanes,
                 std::vector<double>* values, bool* definite) const;

  // x: [n][lanes], in the right sides, out the solutions. scratch: resized to that size.
  void Solve(const std::vector<double>& values, int lanes, double* x,
             std::vector<double>* scratch) const;

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

  double* Row(const Supernode& supernode, int row, int lanes, std::vector<double>* values) const;
  void Begin(const Supernode& to, const std::vector<int>& local, const double* scales,
             const double* diagonal, int lanes, std::vector<double>* values) const;
  void FindSupernodes(const std::vector<int>& parents, std::vector<std::vector<int>> patterns);

  std::vector<int> new_of_old_;
  std::vector<size_t> entries_begin_;  // [n + 1]: of each permuted column
  std::vector<Entry> entries_;
  std::vector<Supernode> supernodes_;
  std::vector<int> supernode_of_;  // [n]
  std::vector<int> rows_;
  size_t num_values_ = 0;
};

}  // namespace limber::bake
