#include "solve/patch_turns.h"

namespace limber {

template <int K>
PatchTurns<K>::PatchTurns(size_t max_turns, size_t blocks)
    : targets(max_turns * K * K),
      blocks_(blocks),
      axis_rows_(max_turns * K * K * blocks),
      axis_values_(max_turns * K * K),
      turns_(max_turns) {}

template <int K>
typename PatchTurns<K>::Images PatchTurns<K>::FreeImages(const SolveKernels& kernels,
                                                         size_t first_axis, size_t count,
                                                         const double* blend) const {
  Images images = {};
  for (size_t i = 0; i < count * K; ++i) {
    images[i] = kernels.dot(axis_rows_.data() + (first_axis * K + i) * blocks_, blend,
                            blocks_ / kBlockLanes);
  }
  return images;
}

template <int K>
void PatchTurns<K>::Update(const SolveKernels& kernels, const PinSet& pins, const double* rotations,
                           const double* blend) {
  if (pins.num_axes == 0) return;
  kernels.rotate_loads(pins.axis_loads.data(), rotations, pins.num_axes, blocks_ / kBlockLanes,
                       axis_rows_.data());
  size_t first_axis = 0;
  for (size_t turn = 0; turn < pins.turns.size(); ++turn) {
    const PatchAxes& patch = pins.turns[turn].patch;
    const Images images = FreeImages(kernels, first_axis, patch.count, blend);
    turns_[turn] = TurnToTarget<K>(patch, images.data(), targets.data() + turn * K * K);
    first_axis += patch.count;
  }
}

// X_i = T f_i: the rows of L^T X are the sums over axes i of root(i, :) T f_i.
template <int K>
void PatchTurns<K>::TakeFromLoad(const PinSet& pins, size_t block, double times,
                                 double* load) const {
  const auto root = pins.system.root();
  size_t axis = 0;
  for (size_t turn = 0; turn < pins.turns.size(); ++turn) {
    const auto& [first_row, patch] = pins.turns[turn];
    for (size_t i = 0; i < patch.count; ++i, ++axis) {
      Eigen::Matrix<double, K, 1> image;
      for (size_t c = 0; c < K; ++c)
        image[static_cast<Eigen::Index>(c)] = axis_rows_[(axis * K + c) * blocks_ + block];
      const Eigen::Matrix<double, K, 1> place = times * (turns_[turn] * image);
      for (size_t p = 0; p < pins.rank(); ++p) {
        const double share =
            root(static_cast<Eigen::Index>(first_row + i), static_cast<Eigen::Index>(p));
        for (size_t c = 0; c < K; ++c)
          load[c * pins.load_stride() + p] -= share * place[static_cast<Eigen::Index>(c)];
      }
    }
  }
}

// The transpose of the above.
template <int K>
void PatchTurns<K>::TakeFromPulled(const SolveKernels& kernels, const PinSet& pins,
                                   const double* residual, AlignedVector<double>* pulled) {
  const auto root = pins.system.root();
  size_t axis = 0;
  for (size_t turn = 0; turn < pins.turns.size(); ++turn) {
    const auto& [first_row, patch] = pins.turns[turn];
    for (size_t i = 0; i < patch.count; ++i, ++axis) {
      Eigen::Matrix<double, K, 1> pull = Eigen::Matrix<double, K, 1>::Zero();
      for (size_t p = 0; p < pins.rank(); ++p) {
        const double share =
            root(static_cast<Eigen::Index>(first_row + i), static_cast<Eigen::Index>(p));
        for (size_t c = 0; c < K; ++c)
          pull[static_cast<Eigen::Index>(c)] -= share * residual[c * pins.load_stride() + p];
      }
      pull = turns_[turn].transpose() * pull;
      for (size_t c = 0; c < K; ++c)
        axis_values_[c * pins.num_axes + axis] = pull[static_cast<Eigen::Index>(c)];
    }
  }
  kernels.add_loads(pins.axis_loads.data(), axis_values_.data(), pins.num_axes, pins.num_axes,
                    blocks_ / kBlockLanes, pulled->data());
}

template <int K>
void PatchTurns<K>::StorePositions(const SolveKernels& kernels, const PinSet& pins,
                                   const double* blend, double* positions) const {
  size_t first_axis = 0;
  for (size_t turn = 0; turn < pins.turns.size(); ++turn) {
    const auto& [first_row, patch] = pins.turns[turn];
    const Images images = FreeImages(kernels, first_axis, patch.count, blend);
    for (size_t i = 0; i < patch.count; ++i) {
      Eigen::Map<Eigen::Matrix<double, K, 1>>{positions + (first_row + i)* K} =
          turns_[turn] * Eigen::Map<const Eigen::Matrix<double, K, 1>>(images.data() + i * K);
    }
    first_axis += patch.count;
  }
}

template class PatchTurns<2>;
template class PatchTurns<3>;

}  // namespace limber
