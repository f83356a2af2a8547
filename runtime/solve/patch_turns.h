// Handles with a target rotation: the axes of a handle's patch (held_rows.h) are held where the
// patch, as the examples and the local rotations alone would have it, has them once it is turned to
// the target. So the patch turns and nothing else about it is asked for: examples that stretch or
// bend it stay free to.
//
// With f_i = F_i(b) the free images, Q the rotation that fits them to the axes at rest, and R the
// target, X_i = R Q^T f_i. Q follows from the last blend, as the local rotations do; given Q, X is
// linear in the blend weights and goes into the convex step as it is.
#pragma once

#include "core/aligned_vector.h"
#include "core/rotation_fit.h"
#include "core/vector.h"
#include "solve/kernels/solve_kernels.h"
#include "solve/pin_set.h"

#include <Eigen/Core>

#include <array>

namespace limber {

// R Q^T for the free images, [count][K]; target: R, row-major.
template <int K>
Eigen::Matrix<double, K, K> TurnToTarget(const PatchAxes& patch, const double* images,
                                         const double* target) {
  using Vector = Eigen::Map<const Eigen::Matrix<double, K, 1>>;
  Eigen::Matrix<double, K, K> fit = Eigen::Matrix<double, K, K>::Zero();
  for (size_t i = 0; i < patch.count; ++i)
    fit += Vector(patch.axes.data() + i * K) * Vector(images + i * K).transpose();
  const Eigen::Map<const Eigen::Matrix<double, K, K, Eigen::RowMajor>> wanted(target);
  return wanted * FitRotation<K>(fit).transpose();
}

template <int K>
class PatchTurns {
 public:
  // blocks: padded number of blocks.
  PatchTurns(size_t max_turns, size_t blocks);

  // R in rig space, [turns][K][K] row-major, in the pin set's order.
  AlignedVector<double> targets;

  // To be called once R has changed, or the targets: Q, and so what X takes of each block.
  void Update(const SolveKernels& kernels, const PinSet& pins, const double* rotations,
              const double* blend);
  // Subtracts that from the rows L^T V_j^T R_j^T of a block, [K][pins.load_stride()], so many
  // times.
  void TakeFromLoad(const PinSet& pins, size_t block, double times, double* load) const;
  // And from the sums V_i L residual of all blocks, planes. residual: [K][pins.load_stride()].
  void TakeFromPulled(const SolveKernels& kernels, const PinSet& pins, const double* residual,
                      AlignedVector<double>* pulled);
  // X of the axes for a blend, into the rows of the pin set's targets.
  void StorePositions(const SolveKernels& kernels, const PinSet& pins, const double* blend,
                      double* positions) const;

 private:
  using Images = std::array<double, size_t{K} * K>;

  Images FreeImages(const SolveKernels& kernels, size_t first_axis, size_t count,
                    const double* blend) const;

  size_t blocks_;
  AlignedVector<double> axis_rows_;            // V_j^T R_j^T of the axes: [axis][K][blocks]
  AlignedVector<double> axis_values_;          // [K][axes], scratch
  Vector<Eigen::Matrix<double, K, K>> turns_;  // R Q^T
};

extern template class PatchTurns<2>;
extern template class PatchTurns<3>;

}  // namespace limber
