// What normals and tangents of a deformed character are made from: built once, then immutable.
//
// A *normal group* is a set of draw vertices that share a solve vertex and whose rest normals agree
// (within kNormalGroupCosine): vertices split at a UV seam are one group, those split at a hard
// edge are several. A group owns the triangles of its vertices. Per frame the triangles of a group
// give its frame (skin_frames.h); the authored normal is stored in the frame that the same
// arithmetic gives at rest, so it comes back at rest and turns with the surface. Where the mesh has
// no normals, the group's own area-weighted normal is used.
#pragma once

#include "core/status.h"
#include "core/vec3.h"
#include "core/vector.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"

#include <cstdint>

namespace limber {

// Rest normals closer than about 2 degrees are one (quantised files differ by half a degree).
inline constexpr float kNormalGroupCosine = 0.9994f;

// A triangle seen from a group's vertex: the other two corners (solve vertices), in order, and the
// coefficients that write the group's two rest tangent directions as sums of the edges to them.
struct SkinCorner {
  uint32_t a = 0, b = 0;
  float first[2] = {0, 0}, second[2] = {0, 0};
};

static_assert(sizeof(SkinCorner) == 24, "as in shaders/shared/skin_layout.h");

// What a draw vertex adds to the frame of its group.
struct SkinDrawVertex {
  Vec3 normal;  // unit, in the group's frame
  uint32_t solve_vertex = 0;
  float tangent[2] = {0, 0};  // coefficients of the group's two pushed directions
  float handedness = 1;
  uint32_t normal_group = 0;
};

static_assert(sizeof(SkinDrawVertex) == 32, "as in shaders/shared/skin_layout.h");

struct SkinTopology {
  float inverse_scale = 1;               // mesh units -> rig units: keeps products in range
  Vector<SkinDrawVertex> draw_vertices;  // [D]
  Vector<uint32_t> group_solve_vertex;   // [G]
  Vector<uint32_t> group_corners;        // [G + 1] first corner of each group
  Vector<SkinCorner> corners;            // [C]
  bool has_tangents = false;

  uint32_t num_groups() const { return static_cast<uint32_t>(group_solve_vertex.size()); }
};

// The rest pose is the first example shape, which rest_normals and rest_tangents must belong to;
// `space` is the rig's. Errors: kMalformed (CheckSkinMesh), kOutOfMemory.
Result<SkinTopology> BuildSkinTopology(const SkinMesh& mesh, const RigSpace& space);

}  // namespace limber
