#include "skin/skin_positions.h"

#include <algorithm>
#include <cstring>

namespace limber {
namespace {

constexpr uint32_t kLanes = SkinLayout::kLanes;
constexpr size_t kMatrixFloats = 12;

// Eight floats; the compiler lowers them to one AVX register or two SSE ones.
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

#if defined(__x86_64__) && defined(__GNUC__)
#define LIMBER_SKIN_AVX2 1
#endif

__attribute__((always_inline)) inline void Load(const float* from, Lanes* lanes) {
  std::memcpy(lanes, from, sizeof(Lanes));
}

__attribute__((always_inline)) inline void SkinBlock(const SkinLayout& layout,
                                                     const SkinTransforms& transforms,
                                                     uint32_t block, Lanes* q) {
  const auto num_handles = static_cast<size_t>(layout.num_handles());
  const auto num_shapes = static_cast<size_t>(layout.num_shapes());
  const float* weights = layout.weights(block);
  const float* shapes = layout.shapes(block);
  const float* matrix = transforms.matrices.data();
  for (size_t h = 0; h < num_handles; ++h) {
    Lanes y0 = {}, y1 = {}, y2 = {}, weight;
    for (size_t s = 0; s < num_shapes; ++s, matrix += kMatrixFloats) {
      Lanes px, py, pz;
      Load(shapes + (s * 3 + 0) * kLanes, &px);
      Load(shapes + (s * 3 + 1) * kLanes, &py);
      Load(shapes + (s * 3 + 2) * kLanes, &pz);
      y0 += matrix[0] * px + matrix[1] * py + (matrix[2] * pz + matrix[3]);
      y1 += matrix[4] * px + matrix[5] * py + (matrix[6] * pz + matrix[7]);
      y2 += matrix[8] * px + matrix[9] * py + (matrix[10] * pz + matrix[11]);
    }
    Load(weights + h * kLanes, &weight);
    q[0] += weight * y0;
    q[1] += weight * y1;
    q[2] += weight * y2;
  }
}

__attribute__((always_inline)) inline void SkinAll(const SkinLayout& layout,
                                                   const SkinTransforms& transforms, Vec3* out) {
  const uint32_t count = layout.num_vertices();
  for (uint32_t block = 0; block < layout.num_blocks(); ++block) {
    Lanes q[3] = {};
    SkinBlock(layout, transforms, block, q);
    const uint32_t first = block * kLanes, end = std::min(first + kLanes, count);
    for (uint32_t v = first; v < end; ++v) {
      const uint32_t lane = v - first;
      out[v] = {q[0][lane] + transforms.origin.x, q[1][lane] + transforms.origin.y,
                q[2][lane] + transforms.origin.z};
    }
  }
}

void SkinAllBaseline(const SkinLayout& layout, const SkinTransforms& transforms, Vec3* out) {
  SkinAll(layout, transforms, out);
}

#ifdef LIMBER_SKIN_AVX2
// AVX2 without FMA: wider registers, the same roundings.
__attribute__((target("avx2"))) void SkinAllAvx2(const SkinLayout& layout,
                                                 const SkinTransforms& transforms, Vec3* out) {
  SkinAll(layout, transforms, out);
}
#endif

Status CheckSizes(int num_handles, int num_shapes, uint32_t num_vertices,
                  const SkinTransforms& transforms, size_t num_out) {
  const size_t expected =
      static_cast<size_t>(num_handles) * static_cast<size_t>(num_shapes) * kMatrixFloats;
  if (transforms.matrices.size() != expected) {
    return Error(StatusCode::kInvalidArgument,
                 "skin transforms: %zu floats, expected %zu (%d handles x %d shapes x 12)",
                 transforms.matrices.size(), expected, num_handles, num_shapes);
  }
  if (num_out != num_vertices) {
    return Error(StatusCode::kInvalidArgument,
                 "skin output: room for %zu positions, expected %u (the solve vertices)", num_out,
                 num_vertices);
  }
  return {};
}

// q += weight * matrix * [p; 1]
void AddTransformed(const float* matrix, Vec3 p, double weight, double* q) {
  for (int row = 0; row < 3; ++row, matrix += 4) {
    q[row] += weight * (double{matrix[0]} * p.x + double{matrix[1]} * p.y +
                        double{matrix[2]} * p.z + matrix[3]);
  }
}

}  // namespace

Status SkinPositionsReference(const SkinMesh& mesh, const SkinTransforms& transforms,
                              std::span<Vec3> out) {
  LIMBER_RETURN_IF_ERROR(CheckSizes(mesh.num_handles, mesh.num_shapes, mesh.num_solve_vertices,
                                    transforms, out.size()));
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  const auto num_shapes = static_cast<size_t>(mesh.num_shapes);
  for (size_t v = 0; v < out.size(); ++v) {
    double q[3] = {};
    for (size_t h = 0; h < num_handles; ++h) {
      const double weight = mesh.weights[v * num_handles + h];
      for (size_t s = 0; s < num_shapes; ++s) {
        AddTransformed(transforms.matrices.data() + (h * num_shapes + s) * kMatrixFloats,
                       mesh.shape_positions[s * out.size() + v], weight, q);
      }
    }
    out[v] = {static_cast<float>(q[0] + transforms.origin.x),
              static_cast<float>(q[1] + transforms.origin.y),
              static_cast<float>(q[2] + transforms.origin.z)};
  }
  return {};
}

Status SkinPositions(const SkinLayout& layout, const SkinTransforms& transforms,
                     std::span<Vec3> out) {
  LIMBER_RETURN_IF_ERROR(CheckSizes(layout.num_handles(), layout.num_shapes(),
                                    layout.num_vertices(), transforms, out.size()));
#ifdef LIMBER_SKIN_AVX2
  if (__builtin_cpu_supports("avx2")) {
    SkinAllAvx2(layout, transforms, out.data());
    return {};
  }
#endif
  SkinAllBaseline(layout, transforms, out.data());
  return {};
}

}  // namespace limber
