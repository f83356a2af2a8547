#include "symmetric_matrices.h"

#include "core/vector.h"

#include <random>

namespace limber::linear {

using Eigen::SparseMatrix;

SparseMatrix<double> RandomMatrix(int size, int per_row, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> column(0, size - 1);
  std::uniform_real_distribution<double> number(-1, 1);
  Vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < size; ++row) {
    entries.emplace_back(row, row, 3.0 * per_row);
    for (int i = 0; i < per_row; ++i) {
      const int other = column(random);
      const double value = number(random);
      entries.emplace_back(row, other, value);
      entries.emplace_back(other, row, value);
    }
  }
  SparseMatrix<double> Q(size, size);
  Q.setFromTriplets(entries.begin(), entries.end());
  return Q;
}

SparseMatrix<double> GridBiharmonic(int side) {
  Vector<Eigen::Triplet<double>> entries;
  const auto edge = [&](int a, int b) {
    entries.emplace_back(a, a, 1);
    entries.emplace_back(b, b, 1);
    entries.emplace_back(a, b, -1);
    entries.emplace_back(b, a, -1);
  };
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const int at = row * side + column;
      if (column + 1 < side) edge(at, at + 1);
      if (row + 1 < side) edge(at, at + side);
    }
  }
  SparseMatrix<double> laplacian(side * side, side * side);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian * laplacian;
}

}  // namespace limber::linear
