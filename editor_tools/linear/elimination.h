// What a sparse Cholesky factorisation is before it has numbers: the order of elimination, its
// tree, and how full L becomes.
#pragma once

#include <Eigen/SparseCore>

#include <cstddef>
#include <vector>

namespace limber::linear {

struct Elimination {
  std::vector<int> new_of_old;  // [n]: the place of each column in the order
  // The entries of each row left of the diagonal, in the new order: columns[begin[row]..),
  // unsorted.
  std::vector<size_t> begin;  // [n + 1]
  std::vector<int> columns;
  std::vector<int> parents;  // [n]: first row below the diagonal of each column of L, -1 for none
  std::vector<int> counts;   // [n]: entries of each column of L, the diagonal among them

  // Of a factorisation.
  double Multiplications() const;
};

// Q: symmetric pattern, given whole. order: [n], the place of each column; those that leave the
// same L are all alike, and of these the one is taken in which each column comes right after its
// subtree.
Elimination Eliminate(const Eigen::SparseMatrix<double>& Q, const std::vector<int>& order);

// Minimum degree is the better order of small and ragged meshes, nested dissection of large and
// regular ones; both are tried, each on a thread.
Elimination EliminateInGoodOrder(const Eigen::SparseMatrix<double>& Q);

}  // namespace limber::linear
