// Cholesky in place on small dense systems: no allocation, the same bits on every run.
#pragma once

#include <cmath>

namespace limber {

// a: size x size, row-major, the lower triangle read and overwritten by L with A = L L^T. Pivots
// that are not positive (rounding in a singular system) are raised to the smallest that is.
inline void CholeskyFactor(double* a, int size) {
  for (int j = 0; j < size; ++j) {
    double* row_j = a + static_cast<long>(j) * size;
    double pivot = row_j[j];
    const double smallest = 1e-15 * std::abs(pivot) + 1e-300;
    for (int m = 0; m < j; ++m)
      pivot -= row_j[m] * row_j[m];
    pivot = std::sqrt(pivot > smallest ? pivot : smallest);
    row_j[j] = pivot;
    for (int i = j + 1; i < size; ++i) {
      double* row_i = a + static_cast<long>(i) * size;
      double sum = row_i[j];
      for (int m = 0; m < j; ++m)
        sum -= row_i[m] * row_j[m];
      row_i[j] = sum / pivot;
    }
  }
}

// x: in the right side, out the solution of L L^T x = b.
inline void CholeskySolve(const double* l, int size, double* x) {
  for (int i = 0; i < size; ++i) {
    double sum = x[i];
    for (int m = 0; m < i; ++m)
      sum -= l[static_cast<long>(i) * size + m] * x[m];
    x[i] = sum / l[static_cast<long>(i) * size + i];
  }
  for (int i = size - 1; i >= 0; --i) {
    double sum = x[i];
    for (int m = i + 1; m < size; ++m)
      sum -= l[static_cast<long>(m) * size + i] * x[m];
    x[i] = sum / l[static_cast<long>(i) * size + i];
  }
}

}  // namespace limber
