// The blocks whose blend weight is not zero: all that sums over B_j R_j have to visit.
#pragma once

#include "core/aligned_vector.h"
#include "core/vector.h"
#include "solve/kernels/solve_kernels.h"
#include "solve/pose_model.h"

#include <cstddef>

namespace limber {

template <int K>
class ActiveBlocks {
 public:
  // Room for all blocks; none is active.
  explicit ActiveBlocks(int num_blocks) : scaled_(static_cast<size_t>(num_blocks) * K * K) {
    blocks_.reserve(static_cast<size_t>(num_blocks));
    weights_.reserve(static_cast<size_t>(num_blocks));
  }

  // blend: B, padded with zeros; rotations: R, planes.
  void Collect(const AlignedVector<double>& blend, const AlignedVector<double>& rotations) {
    blocks_.clear();
    weights_.clear();
    for (size_t j = 0; j < blend.size(); ++j) {
      if (blend[j] == 0) continue;
      double* m = scaled_.data() + blocks_.size() * (size_t{K} * K);
      for (size_t row = 0; row < K; ++row) {
        for (size_t column = 0; column < K; ++column)
          m[row * K + column] = blend[j] * rotations[PlaneIndex<K>(j, row, column)];
      }
      blocks_.push_back(static_cast<int>(j));
      weights_.push_back(blend[j]);
    }
  }

  size_t size() const { return blocks_.size(); }

  // Ascending.
  const Vector<int>& blocks() const { return blocks_; }

  double weight(size_t at) const { return weights_[at]; }  // B_j

  // B_j R_j of the active block `at`, row-major; those of all lie one after the other.
  const double* scaled(size_t at) const { return scaled_.data() + at * (size_t{K} * K); }

 private:
  Vector<int> blocks_;
  Vector<double> weights_;
  AlignedVector<double> scaled_;
};

// product_i += sum_j B_j H_ij R_j^T over the blocks j of i's group; planes.
template <int K>
void AddNearProducts(const SolveKernels& kernels, const PoseModel& model,
                     const ActiveBlocks<K>& active, AlignedVector<double>* product) {
  for (size_t at = 0; at < active.size(); ++at) {
    const int* j = active.blocks().data() + at;
    kernels.add_products(model.near.data(), model.near_stride, j, active.scaled(at), 1,
                         model.near_chunks(*j),
                         product->data() + model.near_first(*j) * kBlockLanes * (size_t{K} * K));
  }
}

}  // namespace limber
