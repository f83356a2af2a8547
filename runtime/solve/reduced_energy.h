// The reduced elastic energy as a sum of squares: no cancellation, so that its square root is good
// to single precision even where targets match an example exactly.
#pragma once

#include "solve/pose_model.h"

#include <Eigen/Core>

#include <vector>

namespace limber {

template <int K>
class ReducedEnergy {
 public:
  using Rotation = Eigen::Matrix<double, K, K>;
  using Modes = Eigen::Matrix<double, Eigen::Dynamic, K, Eigen::RowMajor>;

  explicit ReducedEnergy(const PoseModel& model);

  // The modes that minimise E_d (eq. 9) for these blend weights and rotations: z (r x k) and the
  // translation t (1 x k). targets: X, c x k. blend: B, [G*S]. rotations: [G*S].
  void MinimiseModes(const PoseModel& model, const Modes& targets, const double* blend,
                     const std::vector<Rotation>& rotations, Modes* modes,
                     Eigen::Matrix<double, 1, K>* translation);

  // E_d at the modes of the last call: 1/2 tr(d^T W d) + 1/2 |sum B F R^T|^2, squared rig units.
  double Value(const PoseModel& model, const double* blend, const std::vector<Rotation>& rotations);

 private:
  Modes gap_, answer_;  // X - C b and y, c x k
};

extern template class ReducedEnergy<2>;
extern template class ReducedEnergy<3>;

}  // namespace limber
