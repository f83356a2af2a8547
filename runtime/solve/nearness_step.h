// D of eq. 10: how far each example shape alone is from the targets, group by group. One
// local/global iteration of a FAST model (Jacobson et al. 2012) per shape, warm-started.
#pragma once

#include "core/aligned_vector.h"
#include "solve/pose_model.h"

#include <cstdint>
#include <vector>

namespace limber {

template <int K>
class NearnessStep {
 public:
  explicit NearnessStep(const PoseModel& model);

  // All rotations the identity.
  void Reset();

  // targets: X, [c][K], rig space. hold_rotations: stay at the identity (call Reset before).
  // nearness: out, D_gs = E_g(q_s, R, p_s), [G*S], in squared rig units.
  void Run(const PoseModel& model, const PinSet& pins, const double* targets, bool hold_rotations,
           double* nearness);

 private:
  void MeetTargets(const PoseModel& model, const PinSet& pins, size_t shape, const double* targets);
  void FitRotations(const PoseModel& model, size_t shape);

  double* Rotations(size_t shape) { return rotations_.data() + shape * shape_planes_; }

  const SolveKernels& kernels_;
  size_t shape_planes_;                   // numbers that a shape's rotations take
  AlignedVector<double> rotations_;       // planes over groups, shape after shape
  AlignedVector<double> modes_;           // z, [K][r1 padded]
  AlignedVector<double> gaps_, answers_;  // X - C b and y, [c][K]
  AlignedVector<double> fits_;            // planes over groups
  AlignedVector<double> energies_;        // [G padded]
  std::vector<uint8_t> failed_;           // [G padded]
};

extern template class NearnessStep<2>;
extern template class NearnessStep<3>;

}  // namespace limber
