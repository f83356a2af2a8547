// Sparse Cholesky factors of many matrices of one pattern: the pattern is analysed once, the
// numbers take most of what the machine's arithmetic gives.
//
// Left-looking over supernodes: columns of L with one pattern; those that nearly have one are
// merged. Their panels are dense, and the kernels of panel_kernels/ work on them.
#pragma once

#include "core/vector.h"
#include "linear/elimination.h"
#include "linear/large_buffer.h"
#include "linear/panel_kernels/panel_kernels.h"

#include <Eigen/SparseCore>

#include <cstddef>

namespace limber::linear {

class SupernodalCholesky {
 public:
  // Q: symmetric, n x n, given whole.
  explicit SupernodalCholesky(const Eigen::SparseMatrix<double>& Q,
                              const PanelKernels& kernels = ChoosePanelKernels());

  // The same in an order of elimination that is known.
  SupernodalCholesky(const Eigen::SparseMatrix<double>& Q, Elimination elimination,
                     const PanelKernels& kernels = ChoosePanelKernels());

  int size() const { return static_cast<int>(new_of_old_.size()); }

  // Numbers that a factor takes.
  size_t num_values() const { return num_values_; }

  // L of one matrix, and room to work in. It may be used again and again, by one thread at a time.
  struct Factor {
    bool definite = false;  // else its numbers mean nothing
    LargeBuffer values;     // [num_values]
    Vector<double> x;       // [n], in the order of the elimination
    // Supernodes with rows that are still to be taken from, each listed where the next of these
    // rows belongs; and of a row of the matrix, its place in the panel that is being made.
    Vector<int> head, next, rows_done, local;
  };

  // L L^T = scale Q + diag(diagonal); diagonal: [n]. x: [n], in the right side, out the solution,
  // for half of what Solve costs.
  void FactoriseAndSolve(double scale, const double* diagonal, Factor* factor, double* x) const;

  // The same of any matrix of the pattern: values are its numbers, [Q.nonZeros()] in Q's order, of
  // which those of Q's lower triangle (in the order of elimination) are read.
  void FactoriseAndSolve(const double* values, Factor* factor, double* x) const;

  // x: [n], in the right side, out the solution.
  void Solve(Factor* factor, double* x) const;

 private:
  struct Supernode {
    int first = 0, width = 0;  // its columns
    size_t rows = 0;           // where its row numbers begin in rows_: its own columns, then others
    int num_rows = 0;
    size_t values = 0;  // its panel begins here
    int parent = -1;    // the supernode of the first row beyond its columns
  };

  struct Entry {  // of Q's lower triangle
    size_t place = 0;
    double value = 0;
    size_t source = 0;  // among Q's numbers
  };

  // A matrix of the pattern: what Begin puts where L will be.
  struct Matrix {
    double scale = 1;
    const double* diagonal = nullptr;  // [n]
    const double* values = nullptr;    // instead of both, where it is not null
  };

  void FindSupernodes(const Elimination& elimination);
  void FindRows(const Elimination& elimination);
  void PlaceEntries(const Eigen::SparseMatrix<double>& Q);
  size_t Place(const Supernode& supernode, int place_in_rows, int column) const;
  PanelView Panel(const Supernode& supernode, const Factor& factor) const;
  void Begin(size_t which, const Matrix& matrix, Factor* factor) const;
  void Factorise(const Matrix& matrix, Factor* factor, double* x) const;
  void List(size_t which, int rows_done, Factor* factor) const;
  void TakeProducts(size_t target, Factor* factor) const;
  void Permute(const double* x, Factor* factor) const;
  void SolveBackward(Factor* factor, double* x) const;

  const PanelKernels& kernels_;
  Vector<int> new_of_old_, old_of_new_;
  Vector<Supernode> supernodes_;
  Vector<int> supernode_of_;  // [n]
  Vector<int> rows_;
  Vector<size_t> entries_begin_;  // [supernodes + 1]
  Vector<Entry> entries_;
  Vector<size_t> diagonal_places_;  // [n]
  size_t num_values_ = 0;
};

}  // namespace limber::linear
