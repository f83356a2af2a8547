// The blocks whose blend weight is not zero: all that sums over B_j R_j have to visit.
#pragma once

#include "core/aligned_vector.h"
#include "solve/kernels/solve_kernels.h"

#include <cstddef>
#include <vector>

namespace limber {

template <int K>
class ActiveBlocks {
 public:
  // Room for all blocks; none is active.
  explicit ActiveBlocks(int num_blocks) : scaled_(static_cast<size_t>(num_blocks) * K * K) {
    blocks_.reserve(static_cast<size_t>(num_blocks));
  }

  // blend: B; rotations: R, planes.
  void Collect(const AlignedVector<double>& blend, const AlignedVector<double>& rotations) {
    blocks_.clear();
    for (size_t j = 0; j < blocks_.capacity() && j < blend.size(); ++j) {
      if (blend[j] == 0) continue;
      double* m = scaled_.data() + blocks_.size() * (size_t{K} * K);
      for (size_t row = 0; row < K; ++row) {
        for (size_t column = 0; column < K; ++column)
          m[row * K + column] = blend[j] * rotations[PlaneIndex<K>(j, row, column)];
      }
      blocks_.push_back(static_cast<int>(j));
    }
  }

  size_t size() const { return blocks_.size(); }

  // Ascending.
  const std::vector<int>& blocks() const { return blocks_; }

  // B_j R_j of the active block `at`, row-major; those of all lie one after the other.
  const double* scaled(size_t at) const { return scaled_.data() + at * (size_t{K} * K); }

 private:
  std::vector<int> blocks_;
  AlignedVector<double> scaled_;
};

}  // namespace limber
