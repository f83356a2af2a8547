// What follows from a rig, laid out for the kernels and shared by all its characters. Immutable.
//
// Everything that a frame needs is a sum over blocks (g, s), eight of which make a chunk
// (kernels/solve_kernels.h): neither the mesh's size nor the number of modes appears in it.
#pragma once

#include "core/aligned_vector.h"
#include "core/memory_source.h"
#include "core/status.h"
#include "core/vector.h"
#include "rig/rig.h"
#include "solve/held_rows.h"
#include "solve/kernels/solve_kernels.h"
#include "solve/pin_set.h"

#include <Eigen/Core>

#include <memory>

namespace limber {

class PoseModel : public NewFromSource {
 public:
  // Time and memory grow with (G*S*k)^2, in double from the rig's single-precision tables. Errors:
  // kInvalidArgument (no rig), kNoHandles, kLimitExceeded, kOutOfMemory.
  static Result<std::shared_ptr<const PoseModel>> Create(std::shared_ptr<const Rig> rig);

  std::shared_ptr<const Rig> rig;
  int k = 0, num_groups = 0, num_shapes = 0, num_modes = 0, num_single_modes = 0;  // k G S r r1
  int num_blocks = 0;                               // N = G*S, numbered g*S + s
  Vector<int> pin_of_handle;                        // [H]: row of `pins`, -1 for a free handle
  Vector<int> pinned_handles;                       // those that are pinned in the rig, ascending
  std::shared_ptr<const PinSet> pins;               // made of them
  std::shared_ptr<const HeldRowTable> handle_rows;  // of all handles
  double energy_scale = 0;  // 1/2 mean over shapes of tr H: the size of one example's edges

  size_t chunks() const { return NumChunks(static_cast<size_t>(num_blocks)); }

  size_t group_chunks() const { return NumChunks(static_cast<size_t>(num_groups)); }

  size_t row_chunks() const {
    return NumChunks(static_cast<size_t>(rig->tables().num_transform_rows()));
  }

  // Rows of [z; -R^T], and the same padded.
  size_t single_size() const {
    return static_cast<size_t>(num_single_modes) + static_cast<size_t>(k);
  }

  size_t single_stride() const { return PaddedSize(single_size()); }

  // Memory that the tables below and the pins take; the rig's own is not counted.
  size_t bytes() const;

  // F^T F: block j's column, a k x k matrix of every block, row-major; of a folded rig (without
  // rotations) one number a block, padded.
  const double* GramColumn(int block) const {
    return gram.data() + static_cast<size_t>(block) * gram_stride;
  }

  // Of gram_planes, from one block's column to the next.
  size_t planes_stride() const {
    return chunks() * kBlockLanes * static_cast<size_t>(k) * static_cast<size_t>(k);
  }

  // Columns of H reach over the block's own group: these chunks of the others.
  size_t near_first(int block) const {
    return static_cast<size_t>(block - block % num_shapes) / kBlockLanes;
  }

  size_t near_chunks(int block) const {
    const int end = block - block % num_shapes + num_shapes;
    return NumChunks(static_cast<size_t>(end)) - near_first(block);
  }

  bool is_folded = false;
  size_t gram_stride = 0, near_stride = 0;
  AlignedVector<double> gram, near;
  // The same F^T F as planes in single precision; empty where folded. And |F_i|, zero where folded.
  AlignedVector<float> gram_planes;
  AlignedVector<double> gram_norms;
  // Phi_1 K_z^T: the transforms that block j's edges ask for. [j][row chunk][k][8].
  AlignedVector<float> transform_response;

  // The models of one shape (nearness): shape s from offset s * (size / S) on.
  AlignedVector<float> single_edges_by_mode;   // [S][G][k][r1 padded]
  AlignedVector<float> single_edges_by_group;  // [S][group chunk][r1][k][8]
  // [G*S] of U, as the kernels want it: the rows that a lower bound needs lie together, so that the
  // bounds of all blocks are one walk through memory.
  AlignedVector<float> single_heads, single_tails;
  size_t single_tail_size = 0;       // numbers of one; of a head 8 single_size()
  Vector<double> single_edge_norms;  // [G*S]: |E_gs|

 private:
  PoseModel() = default;
  static Result<std::shared_ptr<const PoseModel>> Build(std::shared_ptr<const Rig> rig);
};

}  // namespace limber
