#include "skin/skin_layout.h"

#include <algorithm>

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

SkinLayout::SkinLayout(const SkinMesh& mesh)
    : num_vertices_(mesh.num_solve_vertices),
      num_handles_(mesh.num_handles),
      num_shapes_(mesh.num_shapes) {
  const auto num_handles = static_cast<size_t>(num_handles_);
  const auto num_shapes = static_cast<size_t>(num_shapes_);
  weights_.resize(num_blocks() * num_handles * kLanes);
  shapes_.resize(num_blocks() * num_shapes * 3 * kLanes);
  for (size_t v = 0; v < num_vertices_; ++v) {
    const size_t block = v / kLanes, lane = v % kLanes;
    for (size_t h = 0; h < num_handles; ++h) {
      weights_[(block * num_handles + h) * kLanes + lane] = mesh.weights[v * num_handles + h];
    }
    for (size_t s = 0; s < num_shapes; ++s) {
      const Vec3& position = mesh.shape_positions[s * num_vertices_ + v];
      for (size_t axis = 0; axis < 3; ++axis) {
        shapes_[((block * num_shapes + s) * 3 + axis) * kLanes + lane] =
            position[static_cast<int>(axis)];
      }
    }
  }
}

}  // namespace limber
