#include "solve/patch_turns.h"

namespace limber {

template <int K>
PatchTurns<K>::PatchTurns(size_t max_turns, size_t blocks)
    : targets(max_turns * K * K),
      blocks_(blocks),
      axis_rows_(max_turns * K * K * blocks),
      turns_(max_turns) {}

template <int K>
void PatchTurns<K>::RotateLoads(const SolveKernels& kernels, const PinSet& pins,
                                const double* rotations) {
  if (pins.num_axes == 0) return;
  kernels.rotate_loads(pins.axis_loads.data(), rotations, pins.num_axes, blocks_ / kBlockLanes,
                       axis_rows_.data());
}

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
void PatchTurns<K>::TakeFromRows(const SolveKernels& kernels, const PinSet& pins,
                                 const double* blend, double* rows) {
  const size_t chunks = blocks_ / kBlockLanes;
  const auto root = pins.system.root();
  size_t first_axis = 0;
  for (size_t turn = 0; turn < pins.turns.size(); ++turn) {
    const auto& [first_row, patch] = pins.turns[turn];
    const Images images = FreeImages(kernels, first_axis, patch.count, blend);
    turns_[turn] = TurnToTarget<K>(patch, images.data(), targets.data() + turn * K * K);
    for (size_t i = 0; i < patch.count; ++i) {
      for (size_t entry = 0; entry < pins.rank() * K * K; ++entry) {
        const size_t q = entry / (size_t{K} * K), to = entry / K % K, from = entry % K;
        const double factor =
            root(static_cast<Eigen::Index>(first_row + i), static_cast<Eigen::Index>(q)) *
            turns_[turn](static_cast<Eigen::Index>(to), static_cast<Eigen::Index>(from));
        kernels.add_scaled(-factor, axis_rows_.data() + ((first_axis + i) * K + from) * blocks_,
                           chunks, rows + (q * K + to) * blocks_);
      }
    }
    first_axis += patch.count;
  }
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
