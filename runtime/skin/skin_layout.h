// Weights and example shapes of a SkinMesh, regrouped for wide arithmetic. Immutable.
#pragma once

#include "core/aligned_vector.h"
#include "core/status.h"
#include "rig/skin_mesh.h"
#include "skin/kernels/skin_kernels.h"

#include <cstdint>
#include <vector>

namespace limber {

// Checks the sizes of everything that skinning reads (weights, shapes, solve_vertex, triangles and
// every index in them), so that the loops may trust them. Errors: kMalformed, naming the table.
Status CheckSkinMesh(const SkinMesh& mesh);

// Vertices come in blocks of kSkinLanes. They are sorted by which handles they follow, so that
// those of a block follow the same ones and all others are left out. What a vertex gets does not
// depend on its block: a handle of weight zero adds zero.
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

  // What the kernels read; views into the layout.
  SkinBlocks blocks() const;

 private:
  void ChooseOrder(const SkinMesh& mesh);
  void FillBlock(const SkinMesh& mesh, uint32_t block);

  uint32_t num_vertices_ = 0;
  int num_handles_ = 0, num_shapes_ = 0;
  std::vector<uint32_t> order_;         // [V] solve vertices
  std::vector<uint32_t> first_handle_;  // [blocks + 1] into handles_
  std::vector<uint32_t> handles_;       // of each block those with a weight, increasing
  AlignedVector<float> weights_;        // [handles_][lanes]
  AlignedVector<float> shapes_;         // [blocks][S][3][lanes]
};

}  // namespace limber
