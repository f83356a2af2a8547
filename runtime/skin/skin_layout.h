// Weights and example shapes of a SkinMesh, regrouped for eight-wide arithmetic. Immutable.
#pragma once

#include "core/status.h"
#include "rig/skin_mesh.h"

#include <cstdint>
#include <vector>

namespace limber {

// Checks the sizes of everything that skinning reads (weights, shapes, solve_vertex, triangles and
// every index in them), so that the loops may trust them. Errors: kMalformed, naming the table.
Status CheckSkinMesh(const SkinMesh& mesh);

class SkinLayout {
 public:
  static constexpr uint32_t kLanes = 8;

  // An empty layout of no vertices.
  SkinLayout() = default;
  // `mesh` must have passed CheckSkinMesh; it is copied, not kept.
  explicit SkinLayout(const SkinMesh& mesh);

  uint32_t num_vertices() const { return num_vertices_; }

  uint32_t num_blocks() const { return (num_vertices_ + kLanes - 1) / kLanes; }

  int num_handles() const { return num_handles_; }

  int num_shapes() const { return num_shapes_; }

  // Block `block`: [H][8] weights and [S][3][8] positions in rig space. Lanes past the last vertex
  // are zero.
  const float* weights(uint32_t block) const {
    return weights_.data() + size_t{block} * static_cast<size_t>(num_handles_) * kLanes;
  }

  const float* shapes(uint32_t block) const {
    return shapes_.data() + size_t{block} * static_cast<size_t>(num_shapes_) * 3 * kLanes;
  }

 private:
  uint32_t num_vertices_ = 0;
  int num_handles_ = 0, num_shapes_ = 0;
  std::vector<float> weights_, shapes_;
};

}  // namespace limber
