// What a sparse Cholesky factorisation is before it has numbers: the order of elimination, its
// tree, and how full L becomes.
#pragma once

#include "core/vector.h"

#include <Eigen/SparseCore>

#include <cstddef>

namespace limber::linear {

struct Elimination {
  Vector<int> new_of_old;  // [n]: the place of each column in the order
  // The entries of each row left of the diagonal, in the new order: columns[begin[row]..),
  // unsorted.
  Vector<size_t> begin;  // [n + 1]
  Vector<int> columns;
  Vector<int> parents;  // [n]: first row below the diagonal of each column of L, -1 for none
  Vector<int> counts;   // [n]: entries of each column of L, the diagonal among them

  // Of a factorisation.
  double Multiplications() const;
};

// Q: symmetric pattern, given whole. order: [n], the place of each column; those that leave the
// same L are all alike, and of these the one is taken in which each column comes right after its
// subtree.
Elimination Eliminate(const Eigen::SparseMatrix<double>& Q, const Vector<int>& order);

// Minimum degree is the better order of small and ragged meshes, nested dissection of large and
// regular ones; both are tried, each on a thread.
Elimination EliminateInGoodOrder(const Eigen::SparseMatrix<double>& Q);

}  // namespace limber::linear
