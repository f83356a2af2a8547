// Weights and example shapes of a SkinMesh, regrouped for wide arithmetic. Immutable.
#pragma once

#include "core/aligned_vector.h"
#include "core/status.h"
#include "core/vector.h"
#include "rig/skin_mesh.h"
#include "skin/kernels/skin_kernels.h"

#include <cstdint>
#include <span>

namespace limber {

// Checks the sizes of everything that skinning reads (weights, shapes, solve_vertex, triangles and
// every index in them), so that the loops may trust them. Errors: kMalformed, naming the table.
Status CheckSkinMesh(const SkinMesh& mesh);

// Vertices come in blocks of kSkinLanes. A *local* shape moves at most half of the mesh; of it only
// what it moves is kept, as the difference to the first one:
//
//   sum_s A_hs P_s = (A_h0 + sum_local A_hs) P_0 + sum_local A_hs (P_s - P_0) + sum_others A_hs P_s
//
// Vertices are sorted by which handles they follow and which local shapes move them, so that those
// of a block have them in common and all others are left out: a face of fifty expressions moves
// little of itself in each. What a vertex gets does not depend on the others of its block while the
// transforms are finite: a weight of zero and a shape that does not move it add zero, and the sign
// of a zero is lost where the origin is added.
//
// NOTE: a difference is rounded relative to the first shape, which is the size of a local one as
// well, since most of it is the same. Other shapes may be of any size and keep their own digits.
class SkinLayout {
 public:
  // An empty layout of no vertices.
  SkinLayout() = default;
  // `mesh` must have passed CheckSkinMesh; it is copied, not kept.
  explicit SkinLayout(const SkinMesh& mesh);

  uint32_t num_vertices() const { return num_vertices_; }

  uint32_t num_blocks() const { return (num_vertices_ + kSkinLanes - 1) / kSkinLanes; }

  int num_handles() const { return num_handles_; }

  int num_shapes() const { return num_shapes_; }

  // Of all blocks together: how many handles they follow.
  size_t num_block_handles() const { return handles_.size(); }

  // Likewise: how many shapes are kept of them.
  size_t num_block_shapes() const { return shape_offsets_.size(); }

  // [S]: 1 for a local shape.
  std::span<const uint8_t> local_shapes() const { return local_shapes_; }

  // What the kernels read; views into the layout.
  SkinBlocks blocks() const;

 private:
  void FindLocalShapes(const SkinMesh& mesh);
  void ChooseOrder(const SkinMesh& mesh);
  void AddWeights(const SkinMesh& mesh, std::span<const uint32_t> vertices);
  void AddShapes(const SkinMesh& mesh, std::span<const uint32_t> vertices);

  uint32_t num_vertices_ = 0;
  int num_handles_ = 0, num_shapes_ = 0;
  Vector<uint8_t> local_shapes_;    // [S]
  Vector<uint32_t> order_;          // [V] solve vertices
  Vector<uint32_t> first_handle_;   // [blocks + 1] into handles_
  Vector<uint32_t> handles_;        // of each block those with a weight, increasing
  AlignedVector<float> weights_;    // [handles_][lanes]
  Vector<uint32_t> first_shape_;    // [blocks + 1] into shape_offsets_
  Vector<uint32_t> shape_offsets_;  // of each block those kept of it, the first last
  AlignedVector<float> points_;     // [shape_offsets_][3][lanes]; see SkinBlocks
};

}  // namespace limber
