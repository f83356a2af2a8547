// D of eq. 10: how far each example shape alone is from the targets, group by group. One
// local/global iteration of a FAST model (Jacobson et al. 2012) per shape, warm-started.
#pragma once

#include "solve/pose_model.h"

#include <Eigen/Core>

#include <vector>

namespace limber {

template <int K>
class NearnessStep {
 public:
  using Rotation = Eigen::Matrix<double, K, K>;
  using Modes = Eigen::Matrix<double, Eigen::Dynamic, K, Eigen::RowMajor>;

  explicit NearnessStep(const PoseModel& model);

  // targets: X, c x k, rig space. rotations: [G*S], read, and updated unless `hold_rotations`.
  // nearness: out, D_gs = E_g(q_s, R, p_s), [G*S], in squared rig units.
  void Run(const PoseModel& model, const Modes& targets, bool hold_rotations,
           std::vector<Rotation>* rotations, double* nearness);

 private:
  void SolveModes(const PoseModel& model, int shape, const Modes& targets,
                  const std::vector<Rotation>& rotations);
  Rotation FitGroup(const PoseModel& model, int shape, int group) const;
  double GroupEnergy(const PoseModel& model, int shape, int group, const Rotation& rotation);

  Modes modes_;         // z, r1 x k
  Modes gap_, answer_;  // X - C b and y, c x k
  Modes stacked_;       // [z; -R^T], (r1 + k) x k
};

extern template class NearnessStep<2>;
extern template class NearnessStep<3>;

}  // namespace limber
