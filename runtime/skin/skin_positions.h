// Eq. 6 on the CPU: skinning transforms -> positions of the solve vertices.
#pragma once

#include "core/status.h"
#include "core/vec3.h"
#include "rig/skin_mesh.h"
#include "skin/skin_layout.h"
#include "skin/skin_transforms.h"

#include <span>

namespace limber {

// The formula as it is printed, summed in double: the yardstick for the faster ways.
// out: [V] mesh space. Errors: kInvalidArgument where a size does not fit the mesh.
Status SkinPositionsReference(const SkinMesh& mesh, const SkinTransforms& transforms,
                              std::span<Vec3> out);

// The same in single precision, eight vertices at a time; within a few float roundings of the
// reference, and the same bits on every processor (no contraction into fused operations).
// Allocates nothing. Any thread.
Status SkinPositions(const SkinLayout& layout, const SkinTransforms& transforms,
                     std::span<Vec3> out);

}  // namespace limber
