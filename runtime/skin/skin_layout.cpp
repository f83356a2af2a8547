#include "skin/skin_layout.h"

#include <algorithm>
#include <numeric>

namespace limber {
namespace {

Status CheckCount(const char* table, size_t found, uint64_t expected) {
  if (found == expected) return {};
  return Error(StatusCode::kMalformed,
               "skin mesh: %s: has %zu elements, expected %llu; bake the character again", table,
               found, static_cast<unsigned long long>(expected));
}

Status CheckIndices(const char* table, const std::vector<uint32_t>& indices, uint32_t limit) {
  const auto bad = std::find_if(indices.begin(), indices.end(),
                                [limit](uint32_t index) { return index >= limit; });
  if (bad == indices.end()) return {};
  return Error(StatusCode::kMalformed,
               "skin mesh: %s[%zu]: is %u, expected below %u; bake the character again", table,
               static_cast<size_t>(bad - indices.begin()), *bad, limit);
}

}  // namespace

Status CheckSkinMesh(const SkinMesh& mesh) {
  if (mesh.num_handles < 1 || mesh.num_shapes < 1) {
    return Error(StatusCode::kMalformed,
                 "skin mesh: %d handles and %d shapes, expected at least one of each",
                 mesh.num_handles, mesh.num_shapes);
  }
  const uint64_t num_solve = mesh.num_solve_vertices, num_draw = mesh.num_draw_vertices;
  const auto num_handles = static_cast<uint64_t>(mesh.num_handles);
  const auto num_shapes = static_cast<uint64_t>(mesh.num_shapes);
  LIMBER_RETURN_IF_ERROR(CheckCount("weights", mesh.weights.size(), num_solve * num_handles));
  LIMBER_RETURN_IF_ERROR(
      CheckCount("shape_positions", mesh.shape_positions.size(), num_solve * num_shapes));
  LIMBER_RETURN_IF_ERROR(CheckCount("solve_vertex", mesh.solve_vertex.size(), num_draw));
  LIMBER_RETURN_IF_ERROR(
      CheckCount("triangles", mesh.triangles.size(), mesh.triangles.size() / 3 * 3));
  if (!mesh.rest_normals.empty()) {
    LIMBER_RETURN_IF_ERROR(CheckCount("rest_normals", mesh.rest_normals.size(), num_draw));
  }
  if (!mesh.rest_tangents.empty()) {
    LIMBER_RETURN_IF_ERROR(CheckCount("rest_tangents", mesh.rest_tangents.size(), 4 * num_draw));
  }
  if (!mesh.texcoords.empty()) {
    LIMBER_RETURN_IF_ERROR(CheckCount("texcoords", mesh.texcoords.size(), 2 * num_draw));
  }
  LIMBER_RETURN_IF_ERROR(CheckIndices("solve_vertex", mesh.solve_vertex, mesh.num_solve_vertices));
  return CheckIndices("triangles", mesh.triangles, mesh.num_draw_vertices);
}

// Sorted by the handles that they follow, then as they were: what is near each other in the mesh
// mostly is so in its order.
void SkinLayout::ChooseOrder(const SkinMesh& mesh) {
  const auto num_handles = static_cast<size_t>(num_handles_);
  // A bit for each handle; beyond 64 they share bits, which makes the order worse and not wrong.
  std::vector<uint64_t> followed(num_vertices_, 0);
  for (size_t v = 0; v < num_vertices_; ++v) {
    for (size_t h = 0; h < num_handles; ++h) {
      if (mesh.weights[v * num_handles + h] != 0) followed[v] |= uint64_t{1} << (63 - h % 64);
    }
  }
  order_.resize(num_vertices_);
  std::iota(order_.begin(), order_.end(), 0u);
  std::stable_sort(order_.begin(), order_.end(),
                   [&](uint32_t a, uint32_t b) { return followed[a] > followed[b]; });
}

void SkinLayout::FillBlock(const SkinMesh& mesh, uint32_t block) {
  const auto num_handles = static_cast<size_t>(num_handles_);
  const size_t first = size_t{block} * kSkinLanes;
  const size_t count = std::min<size_t>(kSkinLanes, num_vertices_ - first);
  for (size_t h = 0; h < num_handles; ++h) {
    float weights[kSkinLanes] = {};
    for (size_t lane = 0; lane < count; ++lane)
      weights[lane] = mesh.weights[size_t{order_[first + lane]} * num_handles + h];
    if (std::all_of(weights, weights + kSkinLanes, [](float w) { return w == 0; })) continue;
    handles_.push_back(static_cast<uint32_t>(h));
    weights_.insert(weights_.end(), weights, weights + kSkinLanes);
  }
  first_handle_.push_back(static_cast<uint32_t>(handles_.size()));
  float* shapes =
      shapes_.data() + size_t{block} * static_cast<size_t>(num_shapes_) * 3 * kSkinLanes;
  for (size_t s = 0; s < static_cast<size_t>(num_shapes_); ++s) {
    for (size_t lane = 0; lane < count; ++lane) {
      const Vec3& position = mesh.shape_positions[s * num_vertices_ + order_[first + lane]];
      for (size_t axis = 0; axis < 3; ++axis)
        shapes[(s * 3 + axis) * kSkinLanes + lane] = position[static_cast<int>(axis)];
    }
  }
}

SkinLayout::SkinLayout(const SkinMesh& mesh)
    : num_vertices_(mesh.num_solve_vertices),
      num_handles_(mesh.num_handles),
      num_shapes_(mesh.num_shapes) {
  ChooseOrder(mesh);
  first_handle_.push_back(0);
  shapes_.resize(size_t{num_blocks()} * static_cast<size_t>(num_shapes_) * 3 * kSkinLanes);
  for (uint32_t block = 0; block < num_blocks(); ++block)
    FillBlock(mesh, block);
}

SkinBlocks SkinLayout::blocks() const {
  SkinBlocks blocks;
  blocks.num_vertices = num_vertices_;
  blocks.num_shapes = static_cast<uint32_t>(num_shapes_);
  blocks.order = order_.data();
  blocks.first_handle = first_handle_.data();
  blocks.handles = handles_.data();
  blocks.weights = weights_.data();
  blocks.shapes = shapes_.data();
  return blocks;
}

}  // namespace limber
