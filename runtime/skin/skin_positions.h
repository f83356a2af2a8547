// Eq. 6 on the CPU: skinning transforms -> positions of the solve vertices.
#pragma once

#include "core/status.h"
#include "core/vec3.h"
#include "core/vector.h"
#include "rig/skin_mesh.h"
#include "skin/skin_layout.h"
#include "skin/skin_transforms.h"

#include <span>

namespace limber {

// The formula as it is printed, summed in double: the yardstick for the faster ways.
// out: [V] mesh space. Errors: kInvalidArgument where a size does not fit the mesh.
Status SkinPositionsReference(const SkinMesh& mesh, const SkinTransforms& transforms,
                              std::span<Vec3> out);

// Scratch of one call, of the rig's size.
using SkinScratch = Vector<float>;

// The same in single precision, many vertices at a time, in the machine's best instruction set
// (kernels/skin_kernels.h says which bits are the same); within a few float roundings of the
// reference. Allocates nothing where `scratch` has been used for the layout before. Any thread.
Status SkinPositions(const SkinLayout& layout, const SkinTransforms& transforms,
                     SkinScratch* scratch, std::span<Vec3> out);

// The room that scratch needs, to be made beforehand.
size_t SkinScratchSize(const SkinLayout& layout);

// With the kernels of one instruction set. For tests.
Status SkinPositionsWith(const SkinKernels& kernels, const SkinLayout& layout,
                         const SkinTransforms& transforms, SkinScratch* scratch,
                         std::span<Vec3> out);

}  // namespace limber
