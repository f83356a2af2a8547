#include "skin/skin_layout.h"

#include "core/vector.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace limber {
namespace {

Status CheckCount(const char* table, size_t found, uint64_t expected) {
  if (found == expected) return {};
  return Error(StatusCode::kMalformed,
               "skin mesh: %s: has %zu elements, expected %llu; bake the character again", table,
               found, static_cast<unsigned long long>(expected));
}

Status CheckIndices(const char* table, const Vector<uint32_t>& indices, uint32_t limit) {
  const auto bad = std::find_if(indices.begin(), indices.end(),
                                [limit](uint32_t index) { return index >= limit; });
  if (bad == indices.end()) return {};
  return Error(StatusCode::kMalformed,
               "skin mesh: %s[%zu]: is %u, expected below %u; bake the character again", table,
               static_cast<size_t>(bad - indices.begin()), *bad, limit);
}

bool IsZero(std::span<const float> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](float x) { return x == 0; });
}

// Finite, so that nothing times it is nothing.
float Difference(float a, float b) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  return std::clamp(a - b, -kLargest, kLargest);
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

void SkinLayout::FindLocalShapes(const SkinMesh& mesh) {
  const auto rest = mesh.shape_positions.begin();
  local_shapes_.push_back(0);
  for (size_t s = 1; s < static_cast<size_t>(num_shapes_); ++s) {
    const auto shape = rest + static_cast<std::ptrdiff_t>(s * num_vertices_);
    const auto unmoved = std::inner_product(rest, rest + num_vertices_, shape, size_t{0},
                                            std::plus<>(), std::equal_to<>());
    local_shapes_.push_back(2 * unmoved >= num_vertices_ ? 1 : 0);
  }
}

// Sorted by the handles that they follow and the local shapes that move them, then as they were:
// what is near each other in the mesh mostly is so in its order.
void SkinLayout::ChooseOrder(const SkinMesh& mesh) {
  const auto num_handles = static_cast<size_t>(num_handles_);

  // A bit for each handle and shape; beyond 64 they share bits, which makes the order worse and not
  // wrong.
  using Needs = std::pair<uint64_t, uint64_t>;  // handles, shapes

  const auto bit = [](size_t i) { return uint64_t{1} << (63 - i % 64); };
  Vector<Needs> needs(num_vertices_);
  for (size_t v = 0; v < num_vertices_; ++v) {
    for (size_t h = 0; h < num_handles; ++h) {
      if (mesh.weights[v * num_handles + h] != 0) needs[v].first |= bit(h);
    }
    for (size_t s = 1; s < static_cast<size_t>(num_shapes_); ++s) {
      if (local_shapes_[s] != 0 &&
          mesh.shape_positions[s * num_vertices_ + v] != mesh.shape_positions[v])
        needs[v].second |= bit(s);
    }
  }
  order_.resize(num_vertices_);
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) {
    return needs[a] == needs[b] ? a < b : needs[a] > needs[b];
  });
}

// The next block's weights of each handle that it follows.
void SkinLayout::AddWeights(const SkinMesh& mesh, std::span<const uint32_t> vertices) {
  const auto num_handles = static_cast<size_t>(num_handles_);
  for (size_t h = 0; h < num_handles; ++h) {
    float weights[kSkinLanes] = {};
    for (size_t lane = 0; lane < vertices.size(); ++lane)
      weights[lane] = mesh.weights[size_t{vertices[lane]} * num_handles + h];
    if (IsZero(weights)) continue;
    handles_.push_back(static_cast<uint32_t>(h));
    weights_.insert(weights_.end(), std::begin(weights), std::end(weights));
  }
  first_handle_.push_back(static_cast<uint32_t>(handles_.size()));
}

// What is kept of the next block's shapes. The first is the last, so that differences, which are
// small, are summed before what is large.
void SkinLayout::AddShapes(const SkinMesh& mesh, std::span<const uint32_t> vertices) {
  const auto num_shapes = static_cast<size_t>(num_shapes_);
  for (size_t i = 1; i <= num_shapes; ++i) {
    const size_t s = i % num_shapes;
    float numbers[3 * kSkinLanes] = {};
    for (size_t lane = 0; lane < vertices.size(); ++lane) {
      const Vec3& rest = mesh.shape_positions[vertices[lane]];
      const Vec3& position = mesh.shape_positions[s * num_vertices_ + vertices[lane]];
      for (int axis = 0; axis < 3; ++axis) {
        numbers[static_cast<size_t>(axis) * kSkinLanes + lane] =
            local_shapes_[s] != 0 ? Difference(position[axis], rest[axis]) : position[axis];
      }
    }
    if (local_shapes_[s] != 0 && IsZero(numbers)) continue;
    points_.insert(points_.end(), std::begin(numbers), std::end(numbers));
    shape_offsets_.push_back(static_cast<uint32_t>(s * kMatrixFloats));
  }
  first_shape_.push_back(static_cast<uint32_t>(shape_offsets_.size()));
}

SkinLayout::SkinLayout(const SkinMesh& mesh)
    : num_vertices_(mesh.num_solve_vertices),
      num_handles_(mesh.num_handles),
      num_shapes_(mesh.num_shapes) {
  FindLocalShapes(mesh);
  ChooseOrder(mesh);
  first_handle_.push_back(0);
  first_shape_.push_back(0);
  const std::span<const uint32_t> order = order_;
  for (size_t begin = 0; begin < order.size(); begin += kSkinLanes) {
    const auto vertices = order.subspan(begin, std::min<size_t>(kSkinLanes, order.size() - begin));
    AddWeights(mesh, vertices);
    AddShapes(mesh, vertices);
  }
  weights_.shrink_to_fit();
  points_.shrink_to_fit();
}

SkinBlocks SkinLayout::blocks() const {
  SkinBlocks blocks;
  blocks.num_vertices = num_vertices_;
  blocks.num_shapes = static_cast<uint32_t>(num_shapes_);
  blocks.order = order_.data();
  blocks.first_handle = first_handle_.data();
  blocks.handles = handles_.data();
  blocks.weights = weights_.data();
  blocks.first_shape = first_shape_.data();
  blocks.shape_offsets = shape_offsets_.data();
  blocks.points = points_.data();
  return blocks;
}

}  // namespace limber
