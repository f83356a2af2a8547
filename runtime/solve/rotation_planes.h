// Rotations of many blocks, laid out for the kernels (kernels/solve_kernels.h).
#pragma once

#include "core/aligned_vector.h"
#include "core/rotation_fit.h"
#include "core/vector.h"
#include "solve/kernels/solve_kernels.h"

#include <cmath>
#include <cstdint>

namespace limber {

template <int K>
void SetIdentity(AlignedVector<double>* planes) {
  for (size_t i = 0; i < planes->size() / (size_t{K} * K); ++i) {
    for (size_t row = 0; row < K; ++row) {
      for (size_t column = 0; column < K; ++column)
        (*planes)[PlaneIndex<K>(i, row, column)] = row == column ? 1 : 0;
    }
  }
}

template <int K>
Eigen::Matrix<double, K, K> MatrixOfBlock(const double* planes, size_t block) {
  Eigen::Matrix<double, K, K> matrix;
  for (size_t row = 0; row < K; ++row) {
    for (size_t column = 0; column < K; ++column) {
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          planes[PlaneIndex<K>(block, row, column)];
    }
  }
  return matrix;
}

// R_i = argmax tr(R fits_i) for `count` blocks, warm-started; where the start is too far away for
// the kernel (targets that jumped) by a singular value decomposition. failed: scratch, [padded].
template <int K>
void FitRotationPlanes(const SolveKernels& kernels, size_t count, const AlignedVector<double>& fits,
                       double* rotations, Vector<uint8_t>* failed) {
  kernels.fit_rotations(fits.data(), rotations, NumChunks(count), failed->data());
  for (size_t i = 0; i < count; ++i) {
    if ((*failed)[i] == 0) continue;
    const Eigen::Matrix<double, K, K> rotation = FitRotation<K>(MatrixOfBlock<K>(fits.data(), i));
    for (size_t row = 0; row < K; ++row) {
      for (size_t column = 0; column < K; ++column) {
        rotations[PlaneIndex<K>(i, row, column)] =
            rotation(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      }
    }
  }
}

}  // namespace limber
