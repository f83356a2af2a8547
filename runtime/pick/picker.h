// Picking on the deformed character: a ray in, the surface point or the handle it means out.
//
// A Picker holds its own copy of the welded surface in a ray tracing structure (Embree), refitted
// as the character moves. All lengths and positions are in the space of the positions that it is
// given, normally mesh space. Nothing here knows of screens; camera rays are the caller's.
//
// A pick allocates nothing and takes no lock; any number of threads may pick at once while nobody
// updates. Update allocates nothing of Limber's own; Embree's commit takes a lock of its own and
// makes one small allocation, whatever the size of the mesh. Nothing starts a thread. The caller's
// floating-point control word (rounding, flush to zero, exception masks) is left as it was.
#pragma once

#include "core/status.h"
#include "core/vec3.h"
#include "rig/skin_mesh.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace limber {

// A half line, or a segment where `far_distance` is finite. The direction may have any length but
// zero; distances are always measured in units of space, not of the direction.
struct PickRay {
  Vec3 origin;
  Vec3 direction = {0, 0, -1};
  float near_distance = 0;
  float far_distance = std::numeric_limits<float>::infinity();
};

struct SurfaceHit {
  float distance = 0;                           // along the ray
  uint32_t triangle = 0;                        // index into SkinMesh::triangles / 3
  std::array<float, 3> barycentrics = {};       // of the triangle's corners; >= 0, sum one
  std::array<uint32_t, 3> solve_vertices = {};  // the corners
  Vec3 point;                                   // sum of barycentrics times corners
  Vec3 normal;                                  // unit; corners run counter-clockwise about it
  bool front_facing = true;                     // the ray comes from the side of the normal
};

struct HandlePickOptions {
  // A handle counts when its distance from the ray is at most radius + cone_tangent * t, with t its
  // distance along the ray. For dots of a fixed size on the screen give cone_tangent = half the
  // dot's width over the distance of the image plane for a perspective camera (all rays begin in
  // one eye), and radius alone for an orthographic one.
  float radius = 0;
  float cone_tangent = 0;
  // Handles behind the surface are passed over; false picks them as if the surface were glass.
  bool occlusion = true;
  // How far inside the surface a handle still counts as visible, as a fraction of the character's
  // current diagonal: handles lie on the surface, or a little below it when a target is not
  // reached.
  float depth_tolerance = 0.01f;
};

struct HandleHit {
  int handle = -1;     // index into the given positions
  float distance = 0;  // t: along the ray
  float offset = 0;    // from the ray, at right angles
};

class Picker {
 public:
  // Builds the structure over the mesh's triangles (through solve_vertex) at the given positions,
  // one for each solve vertex. The mesh is copied as far as it is needed. Triangles without area
  // are allowed and never hit. Errors: kInvalidArgument (number of positions, not finite),
  // kMalformed (an index out of range), kDegenerate (no triangle), kDeviceError (Embree's),
  // kOutOfMemory.
  static Result<Picker> Create(const SkinMesh& mesh, std::span<const Vec3> solve_positions);
  Picker(Picker&&) noexcept;
  Picker& operator=(Picker&&) noexcept;
  ~Picker();

  // Moves the surface. Errors: kInvalidArgument where the number is wrong or a position is not
  // finite (or beyond 1e18) - then the last good surface stays; kDeviceError.
  Status Update(std::span<const Vec3> solve_positions);

  // The first point of the surface, from either side. Of triangles hit at the same distance to
  // within 1e-6 of it (a shared edge, a doubled layer) the one with the lowest index is returned.
  // Nothing for a ray that is not finite or has no direction.
  std::optional<SurfaceHit> PickSurface(const PickRay& ray) const;

  // The handle that the ray means: the smallest offset as a fraction of the allowed one, then the
  // nearest, then the lowest index. Positions that are not finite are never picked.
  std::optional<HandleHit> PickHandle(const PickRay& ray, std::span<const Vec3> handle_positions,
                                      const HandlePickOptions& options) const;

  // Diagonal of the bounding box of the current positions.
  float diagonal() const;

 private:
  struct Impl;
  explicit Picker(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
