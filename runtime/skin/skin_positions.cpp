#include "skin/skin_positions.h"

#include <algorithm>

namespace limber {
namespace {

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

// The matrices, but of each handle the first one with those of local shapes added, and the last
// columns of all.
void SumMatrices(std::span<const uint8_t> local_shapes, std::span<const float> matrices,
                 float* out) {
  std::copy(matrices.begin(), matrices.end(), out);
  const size_t handle_floats = local_shapes.size() * kMatrixFloats;
  for (size_t begin = 0; begin < matrices.size(); begin += handle_floats) {
    double sum[kMatrixFloats] = {};
    for (size_t s = 0; s < local_shapes.size(); ++s) {
      const float* matrix = matrices.data() + begin + s * kMatrixFloats;
      const bool is_all = s == 0 || local_shapes[s] != 0;
      for (size_t i = is_all ? 0 : 3; i < kMatrixFloats; i += is_all ? 1 : 4)
        sum[i] += double{matrix[i]};
    }
    for (size_t i = 0; i < kMatrixFloats; ++i)
      out[begin + i] = static_cast<float>(sum[i]);
  }
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

size_t SkinScratchSize(const SkinLayout& layout) {
  return static_cast<size_t>(layout.num_handles()) * static_cast<size_t>(layout.num_shapes()) *
         kMatrixFloats;
}

Status SkinPositions(const SkinLayout& layout, const SkinTransforms& transforms,
                     SkinScratch* scratch, std::span<Vec3> out) {
  return SkinPositionsWith(ChooseSkinKernels(), layout, transforms, scratch, out);
}

Status SkinPositionsWith(const SkinKernels& kernels, const SkinLayout& layout,
                         const SkinTransforms& transforms, SkinScratch* scratch,
                         std::span<Vec3> out) {
  LIMBER_RETURN_IF_ERROR(CheckSizes(layout.num_handles(), layout.num_shapes(),
                                    layout.num_vertices(), transforms, out.size()));
  scratch->resize(SkinScratchSize(layout));
  SumMatrices(layout.local_shapes(), transforms.matrices, scratch->data());
  kernels.skin(layout.blocks(), scratch->data(), &transforms.origin.x,
               reinterpret_cast<float*>(out.data()));
  return {};
}

}  // namespace limber
