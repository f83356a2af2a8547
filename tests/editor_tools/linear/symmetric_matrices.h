// Sparse symmetric matrices, given whole, to eliminate.
#pragma once

#include <Eigen/SparseCore>

#include <cstdint>

namespace limber::linear {

// Diagonally dominant; `per_row` random entries beside the diagonal.
Eigen::SparseMatrix<double> RandomMatrix(int size, int per_row, uint32_t seed);

// The Laplacian's square on a grid, side x side: the kind of matrix that weights come from. Its
// kernel is the constant.
Eigen::SparseMatrix<double> GridBiharmonic(int side);

}  // namespace limber::linear
