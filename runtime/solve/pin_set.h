// What is held at the moment, and everything about it that a frame needs. Room for a number of
// rows is taken at construction; Build fills it in O(c^3 S + G S k c^2 + n c^2) for c rows,
// whatever the mesh's size, and allocates nothing.
#pragma once

#include "core/aligned_vector.h"
#include "core/vector.h"
#include "rig/rig.h"
#include "solve/constraint_system.h"
#include "solve/held_rows.h"
#include "solve/kernels/solve_kernels.h"

#include <span>

namespace limber {

struct Hold {
  HeldRow row;
  double compliance = 0;  // rig units; 0: exactly
};

// The orientation of a handle's patch: rows first_row on, one for each of its axes. They are held
// where the patch, as the examples make it, has its axes once turned to a target rotation.
struct TurnedPatch {
  size_t first_row = 0;
  PatchAxes patch;
};

class PinSet {
 public:
  // max_turns: how many patches may be turned; their axes are among the max_rows.
  PinSet(const Rig& rig, size_t max_rows, size_t max_turns = 0);

  // holds: 1 to max_rows, one of them at least a point of the skin; turns: which of them are the
  // axes of patches. The rig is that of construction.
  void Build(const Rig& rig, std::span<const Hold> holds, std::span<const TurnedPatch> turned = {});

  size_t capacity() const { return holds_capacity_; }

  size_t bytes() const;  // held in tables

  size_t size() const { return system.size(); }  // c

  size_t rank() const { return system.rank(); }  // q

  // C, W = L L^T and w: the pins' energy is 1/2 |L^T (X - C b)|^2.
  ConstraintSystem system;

  // V_i L for every block, with V_i = K_z,i C^T: [chunk][k][q][8], and of one block alone, [k]
  // [load_stride] with zeros past q.
  AlignedVector<double> loads;

  const double* BlockLoad(size_t block) const {
    return block_loads_.data() + block * dimension_ * load_stride();
  }

  size_t load_stride() const { return LoadStride(rank()); }

  // Of that many rows, at most.
  static size_t LoadStride(size_t rows) {
    return (rows + kQuadLanes - 1) / kQuadLanes * kQuadLanes;
  }

  // V_i w^T, what block i shifts the translation by: [k][N padded].
  AlignedVector<double> shifts;
  // The transforms of a translation and those that the pins' residuals ask for, phi_0 | Phi_1 C^T
  // L: 1 + q columns in bunches of k, [bunch][row chunk][k][8].
  AlignedVector<float> transforms;

  Vector<TurnedPatch> turns;
  // V_i of the turns' rows, as `loads`: [chunk][k][axes][8].
  AlignedVector<double> axis_loads;
  size_t num_axes = 0;  // rows of all turns together

  // The models of one shape. C padded with zeros: [c][r1 + k padded]; W: [c][c].
  const double* single_modes(size_t shape) const {
    return single_modes_.data() + shape * size() * single_stride_;
  }

  const double* single_response(size_t shape) const {
    return single_response_.data() + shape * size() * size();
  }

 private:
  void LayOutAxes(std::span<const Hold> holds);
  void LayOutLoads(std::span<const Hold> holds);
  void LayOutTransforms(const Rig& rig, std::span<const Hold> holds);
  void BuildSingles(std::span<const Hold> holds);

  size_t holds_capacity_, dimension_, num_blocks_, num_transforms_, num_shapes_;
  size_t single_stride_, num_single_modes_;
  ConstraintSystem single_system_;
  Vector<ConstraintRow> rows_;  // scratch
  AlignedVector<double> block_loads_;
  AlignedVector<double> single_modes_;
  Vector<double> single_response_;
};

}  // namespace limber
