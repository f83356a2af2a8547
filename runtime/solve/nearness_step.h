// D of eq. 10: how far each example shape alone is from the targets, group by group. One
// local/global iteration of a FAST model (Jacobson et al. 2012) per shape, warm-started.
//
// The iteration is cheap; the energies D of all groups and shapes are not, and few of them matter:
// those of the weights in use, and of weights that might come into use. So D is evaluated where it
// is asked for, and as far as it is asked for: D = |U x|^2 is summed a few rows of U at a time, and
// every partial sum is a lower bound (eight rows of a hundred give nine tenths of sqrt(D)). From
// one call to the next sqrt(D) falls by at most |dz| + |E_g| |dR|: the whitened modes of a model
// have |J_g dz| <= |dz|.
#pragma once

#include "core/vector.h"
#include "solve/pose_model.h"

#include <cstdint>

namespace limber {

template <int K>
class NearnessStep {
 public:
  // What one call leaves to the next; everything else is scratch.
  struct Memory {
    AlignedVector<double> rotations, modes;
    Vector<double> lower;
  };

  static Memory MakeMemory(const PoseModel& model);

  // Lends or takes back that memory: exchanges it with *memory's.
  void Exchange(Memory* memory) {
    memory_.rotations.swap(memory->rotations);
    memory_.modes.swap(memory->modes);
    memory_.lower.swap(memory->lower);
  }

  // max_pins: rows of the largest pin set that Run will see, where larger than the model's own.
  explicit NearnessStep(const PoseModel& model, size_t max_pins = 0);

  // All rotations the identity, nothing known of D.
  void Reset();

  // targets: X, [c][K], rig space. hold_rotations: stay at the identity (call Reset before).
  // turns: target rotations of the pin set's patches, as PatchTurns::targets.
  void Run(const PoseModel& model, const PinSet& pins, const double* targets, bool hold_rotations,
           const double* turns = nullptr);

  // sqrt(D_gs), D_gs = E_g(q_s, R, p_s) in squared rig units, after Run.
  double Root(const PoseModel& model, int block);

  // No more than sqrt(D_gs).
  double LowerBound(int block) const { return memory_.lower[static_cast<size_t>(block)]; }

  // The same, evaluated until it is at_least that or is_exact.
  double RaiseBound(const PoseModel& model, int block, double at_least);

  bool is_exact(int block) const { return rows_done_[static_cast<size_t>(block)] >= size_; }

 private:
  void MeetTargets(const PoseModel& model, const PinSet& pins, size_t shape, const double* targets,
                   const double* turns);
  void FitRotations(const PoseModel& model, size_t shape);
  void LowerBounds(const PoseModel& model, size_t shape);

  double* Rotations(size_t shape) { return memory_.rotations.data() + shape * shape_planes_; }

  double* Modes(size_t shape) { return memory_.modes.data() + shape * K * stride_; }

  const SolveKernels& kernels_;
  size_t shape_planes_, size_, stride_;  // a shape's rotations; rows of [z; -R^T], and padded
  // Rotations: planes over groups, shape after shape. Modes: [z; -R^T of the last group asked for],
  // [S][K][stride]. Lower: [G*S].
  Memory memory_;
  AlignedVector<double> last_rotations_;  // one shape's before
  AlignedVector<double> last_modes_;      // one shape's before
  AlignedVector<double> gaps_;            // X - C b, [c][K]
  AlignedVector<double> images_;          // one column of C b, then of y, [c]
  AlignedVector<double> fits_;            // planes over groups
  AlignedVector<double> turned_;          // |dR| of one shape's groups, [G padded]
  AlignedVector<double> squares_;         // [G*S][8]: what the rows done add to D
  Vector<size_t> rows_done_;              // [G*S]: rows of U
  Vector<uint8_t> failed_;                // [G padded]
};

extern template class NearnessStep<2>;
extern template class NearnessStep<3>;

}  // namespace limber
