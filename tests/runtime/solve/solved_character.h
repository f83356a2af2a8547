// Characters made in code, baked in memory, for tests of the solver.
#pragma once

#include "bake/bake.h"
#include "core/vector.h"
#include "rig/rig.h"
#include "skin/skin_transforms.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

namespace limber::test {

inline std::shared_ptr<const Rig> BakeInMemory(const bake::RawCharacter& raw,
                                               const bake::BakeOptions& options = {}) {
  Result<bake::BakedCharacter> baked = bake::Bake(raw, raw.marked_handles, options, {});
  EXPECT_TRUE(baked.ok()) << baked.status().message();
  if (!baked.ok()) return nullptr;
  Result<std::shared_ptr<const Rig>> rig =
      Rig::Create(raw.name, std::move(baked->tables), std::move(baked->mesh));
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  return rig.ok() ? *rig : nullptr;
}

// Eq. 6 in double, straight from the tables: [V] positions in mesh space.
inline Vector<Eigen::Vector3d> SkinNaively(const Rig& rig, const SkinTransforms& transforms) {
  const SkinMesh& mesh = rig.mesh();
  Vector<Eigen::Vector3d> positions;
  for (uint32_t v = 0; v < mesh.num_solve_vertices; ++v) {
    Eigen::Vector3d q(transforms.origin.x, transforms.origin.y, transforms.origin.z);
    for (int h = 0; h < mesh.num_handles; ++h) {
      const double weight = mesh.weights[size_t{v} * mesh.num_handles + h];
      for (int s = 0; s < mesh.num_shapes; ++s) {
        const float* m = &transforms.matrices[(size_t(h) * mesh.num_shapes + s) * 12];
        const Vec3 p = mesh.shape_positions[size_t(s) * mesh.num_solve_vertices + v];
        for (int row = 0; row < 3; ++row) {
          q[row] += weight * (double{m[4 * row]} * p.x + double{m[4 * row + 1]} * p.y +
                              double{m[4 * row + 2]} * p.z + double{m[4 * row + 3]});
        }
      }
    }
    positions.push_back(q);
  }
  return positions;
}

inline Eigen::Vector3d ShapePosition(const Rig& rig, int shape, uint32_t vertex) {
  const Vec3 p = rig.ToMesh(
      rig.mesh().shape_positions[size_t(shape) * rig.mesh().num_solve_vertices + vertex]);
  return {p.x, p.y, p.z};
}

}  // namespace limber::test
