// Normals and tangents of the deformed surface, recomputed from its triangles (not blended).
#pragma once

#include "core/vec3.h"
#include "skin/skin_topology.h"

#include <span>

namespace limber {

// What the triangles of one normal group say about the deformed surface at its vertex.
struct SurfaceFrame {
  // 1, or 0: no triangle has area, or they are beyond all size.
  uint32_t valid = 0;
  Vec3 t, b, n;        // orthonormal, right-handed; n the area-weighted normal, t and b
                       // nearest to the pushed directions
  Vec3 first, second;  // the two rest tangent directions pushed forward, not normalised
};

// `positions` are those of the solve vertices, in mesh units; an offset common to all changes
// nothing but costs digits. Finite for any input: where the sums of areas and edges exceed 1e15 in
// rig units, or are not finite, the frame is not valid and its directions are zero.
SurfaceFrame ComputeSurfaceFrame(const SkinTopology& topology, uint32_t group,
                                 std::span<const Vec3> positions);

// A tangent as glTF has it: unit direction, and handedness of the bitangent.
struct Tangent {
  Vec3 direction;
  float handedness = 1;
};

static_assert(sizeof(Tangent) == 16, "VEC4, as in a vertex buffer");

// Normal and tangent of one draw vertex from the frame of its group. Both are unit and orthogonal
// for any frame of ComputeSurfaceFrame; without a valid one the normal is the stored one.
void ApplyFrame(const SurfaceFrame& frame, const SkinDrawVertex& vertex, Vec3* normal,
                Tangent* tangent);

}  // namespace limber
