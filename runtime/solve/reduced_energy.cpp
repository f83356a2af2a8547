#include "solve/reduced_energy.h"

namespace limber {

template <int K>
ReducedEnergy<K>::ReducedEnergy(const PoseModel& model)
    : gap_(static_cast<Eigen::Index>(model.pinned.size()), K),
      answer_(static_cast<Eigen::Index>(model.pinned.size()), K) {}

template <int K>
void ReducedEnergy<K>::MinimiseModes(const PoseModel& model, const Modes& targets,
                                     const double* blend, const std::vector<Rotation>& rotations,
                                     Modes* modes, Eigen::Matrix<double, 1, K>* translation) {
  const Eigen::Index r = model.num_modes;
  const float* table = model.rig->tables().mode_edges.data();
  modes->setZero();  // b = sum_gs B_gs K_z,gs^T R_gs^T
  for (int block = 0; block < model.num_blocks; ++block) {
    if (blend[block] == 0) continue;
    for (int axis = 0; axis < K; ++axis) {
      const float* edges = table + (static_cast<Eigen::Index>(block) * K + axis) * r;
      const Eigen::Matrix<double, 1, K> column =
          blend[block] * rotations[block].col(axis).transpose();
      for (Eigen::Index m = 0; m < r; ++m)
        modes->row(m) += static_cast<double>(edges[m]) * column;
    }
  }
  const ConstraintSystem& constraints = model.constraints;
  gap_ = targets;
  gap_ -= constraints.modes.lazyProduct(*modes);
  answer_ = constraints.response.lazyProduct(gap_);
  *translation = constraints.translation.lazyProduct(gap_);
  *modes += constraints.modes.transpose().lazyProduct(answer_);
}

template <int K>
double ReducedEnergy<K>::Value(const PoseModel& model, const double* blend,
                               const std::vector<Rotation>& rotations) {
  const RigTables& tables = model.rig->tables();
  double energy = 0.5 * gap_.cwiseProduct(answer_).sum();
  const int axes = tables.has_rotations ? K : 1;
  if (axes == 1) {
    // Folded: F^T F is the Gram matrix of whole shapes.
    const float* row = tables.residual_factor.data();
    for (int i = 0; i < tables.residual_rank; ++i, row += model.num_blocks) {
      double sum = 0;
      for (int j = 0; j < model.num_blocks; ++j)
        sum += blend[j] * static_cast<double>(row[j]);
      energy += 0.5 * sum * sum;
    }
    return energy;
  }
  const float* row = tables.residual_factor.data();
  const Eigen::Index row_length = Eigen::Index{model.num_blocks} * K;
  for (int i = 0; i < tables.residual_rank; ++i, row += row_length) {
    Eigen::Matrix<double, K, 1> sum = Eigen::Matrix<double, K, 1>::Zero();
    for (int j = 0; j < model.num_blocks; ++j) {
      if (blend[j] == 0) continue;
      Eigen::Matrix<double, K, 1> edge;
      for (int axis = 0; axis < K; ++axis)
        edge[axis] = row[j * K + axis];
      sum += blend[j] * (rotations[j] * edge);
    }
    energy += 0.5 * sum.squaredNorm();
  }
  return energy;
}

template class ReducedEnergy<2>;
template class ReducedEnergy<3>;

}  // namespace limber
