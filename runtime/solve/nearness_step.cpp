#include "solve/nearness_step.h"

#include "core/rotation_fit.h"

namespace limber {

template <int K>
NearnessStep<K>::NearnessStep(const PoseModel& model)
    : modes_(model.num_single_modes, K),
      gap_(static_cast<Eigen::Index>(model.pinned.size()), K),
      answer_(static_cast<Eigen::Index>(model.pinned.size()), K),
      stacked_(model.num_single_modes + K, K) {}

// z = b + C^T y with b = sum_g K_g^T R_g^T, as in constraint_system.h.
template <int K>
void NearnessStep<K>::SolveModes(const PoseModel& model, int shape, const Modes& targets,
                                 const std::vector<Rotation>& rotations) {
  const Eigen::Index r1 = model.num_single_modes;
  const float* edges = model.rig->tables().single_edges.data() +
                       static_cast<Eigen::Index>(shape) * model.num_groups * K * r1;
  modes_.setZero();
  for (int g = 0; g < model.num_groups; ++g) {
    const Rotation& rotation = rotations[g * model.num_shapes + shape];
    for (int axis = 0; axis < K; ++axis, edges += r1) {
      for (Eigen::Index m = 0; m < r1; ++m) {
        for (int c = 0; c < K; ++c)
          modes_(m, c) += edges[m] * rotation(c, axis);
      }
    }
  }
  const ConstraintSystem& constraints = model.single_constraints[static_cast<size_t>(shape)];
  gap_ = targets;
  gap_ -= constraints.modes.lazyProduct(modes_);
  answer_ = constraints.response.lazyProduct(gap_);
  modes_ += constraints.modes.transpose().lazyProduct(answer_);
}

template <int K>
typename NearnessStep<K>::Rotation NearnessStep<K>::FitGroup(const PoseModel& model, int shape,
                                                             int group) const {
  const Eigen::Index r1 = model.num_single_modes;
  const float* edges = model.rig->tables().single_edges.data() +
                       (static_cast<Eigen::Index>(shape) * model.num_groups + group) * K * r1;
  Rotation fit = Rotation::Zero();
  for (int axis = 0; axis < K; ++axis, edges += r1) {
    for (Eigen::Index m = 0; m < r1; ++m) {
      for (int c = 0; c < K; ++c)
        fit(axis, c) += edges[m] * modes_(m, c);
    }
  }
  return FitRotation<K>(fit);
}

// |U [z; -R^T]|^2, U upper triangular and packed by rows.
template <int K>
double NearnessStep<K>::GroupEnergy(const PoseModel& model, int shape, int group,
                                    const Rotation& rotation) {
  const Eigen::Index size = model.num_single_modes + K;
  const float* factor =
      model.rig->tables().single_group_factors.data() +
      (static_cast<Eigen::Index>(shape) * model.num_groups + group) * size * (size + 1) / 2;
  stacked_.template bottomRows<K>() = -rotation.transpose();
  double energy = 0;
  for (Eigen::Index row = 0; row < size; ++row) {
    Eigen::Matrix<double, 1, K> sum = Eigen::Matrix<double, 1, K>::Zero();
    for (Eigen::Index column = row; column < size; ++column) {
      sum += static_cast<double>(*factor++) * stacked_.row(column);
    }
    energy += sum.squaredNorm();
  }
  return energy;
}

template <int K>
void NearnessStep<K>::Run(const PoseModel& model, const Modes& targets, bool hold_rotations,
                          std::vector<Rotation>* rotations, double* nearness) {
  for (int s = 0; s < model.num_shapes; ++s) {
    SolveModes(model, s, targets, *rotations);
    stacked_.topRows(model.num_single_modes) = modes_;
    for (int g = 0; g < model.num_groups; ++g) {
      const int block = g * model.num_shapes + s;
      if (!hold_rotations) (*rotations)[block] = FitGroup(model, s, g);
      nearness[block] = GroupEnergy(model, s, g, (*rotations)[block]);
    }
  }
}

template class NearnessStep<2>;
template class NearnessStep<3>;

}  // namespace limber
