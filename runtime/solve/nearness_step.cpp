#include "solve/nearness_step.h"

#include "solve/rotation_planes.h"

namespace limber {

template <int K>
NearnessStep<K>::NearnessStep(const PoseModel& model)
    : kernels_(ChooseSolveKernels<K>()),
      shape_planes_(model.group_chunks() * K * K * kBlockLanes),
      rotations_(static_cast<size_t>(model.num_shapes) * shape_planes_),
      modes_(model.single_stride() * K),
      gaps_(static_cast<size_t>(model.rig->num_handles()) * K),
      answers_(gaps_),
      fits_(shape_planes_),
      energies_(model.group_chunks() * kBlockLanes),
      failed_(energies_.size()) {
  Reset();
}

template <int K>
void NearnessStep<K>::Reset() {
  SetIdentity<K>(&rotations_);
}

// z = b + C^T y with b = sum_g K_g^T R_g^T, y = W (X - C b), as in constraint_system.h.
template <int K>
void NearnessStep<K>::MeetTargets(const PoseModel& model, const PinSet& pins, size_t shape,
                                  const double* targets) {
  const auto groups = static_cast<size_t>(model.num_groups);
  const size_t stride = model.single_stride(), count = pins.size();
  kernels_.single_modes(model.single_edges_by_mode.data() + shape * groups * K * stride,
                        Rotations(shape), groups, stride / kBlockLanes, modes_.data());
  const double* held = pins.single_modes.data() + shape * count * stride;
  for (size_t p = 0; p < count; ++p) {
    for (size_t c = 0; c < K; ++c) {
      gaps_[p * K + c] =
          targets[p * K + c] -
          kernels_.dot(held + p * stride, modes_.data() + c * stride, stride / kBlockLanes);
    }
  }
  const Eigen::MatrixXd& response = pins.single_response[shape];
  for (size_t p = 0; p < count; ++p) {
    const double* row = response.data() + p * count;  // symmetric
    for (size_t c = 0; c < K; ++c) {
      double answer = 0;
      for (size_t other = 0; other < count; ++other)
        answer += row[other] * gaps_[other * K + c];
      kernels_.add_scaled(answer, held + p * stride, stride / kBlockLanes,
                          modes_.data() + c * stride);
    }
  }
}

template <int K>
void NearnessStep<K>::FitRotations(const PoseModel& model, size_t shape) {
  const auto modes = static_cast<size_t>(model.num_single_modes);
  kernels_.single_fits(
      model.single_edges_by_group.data() + shape * model.group_chunks() * modes * K * kBlockLanes,
      modes_.data(), modes, model.group_chunks(), fits_.data());
  FitRotationPlanes<K>(kernels_, static_cast<size_t>(model.num_groups), fits_, Rotations(shape),
                       &failed_);
}

template <int K>
void NearnessStep<K>::Run(const PoseModel& model, const PinSet& pins, const double* targets,
                          bool hold_rotations, double* nearness) {
  const auto shapes = static_cast<size_t>(model.num_shapes);
  const size_t size = static_cast<size_t>(model.num_single_modes) + K;
  const size_t factor_size = model.group_chunks() * size * (size + 1) / 2 * kBlockLanes;
  for (size_t s = 0; s < shapes; ++s) {
    MeetTargets(model, pins, s, targets);
    if (!hold_rotations) FitRotations(model, s);
    kernels_.single_energies(model.single_factors.data() + s * factor_size, modes_.data(),
                             Rotations(s), static_cast<size_t>(model.num_single_modes),
                             model.group_chunks(), energies_.data());
    for (size_t g = 0; g < static_cast<size_t>(model.num_groups); ++g)
      nearness[g * shapes + s] = energies_[g];
  }
}

template class NearnessStep<2>;
template class NearnessStep<3>;

}  // namespace limber
