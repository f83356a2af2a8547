// Welding: draw vertices that coincide in every example shape become one solve vertex.
#pragma once

#include "core/status.h"
#include "geometry/solve_mesh.h"

#include <cstdint>
#include <span>

namespace limber::geometry {

// shapes: S of D x 3. triangles: draw vertices. Two draw vertices are welded when they coincide
// within `tolerance` (absolute, mesh units) in *every* shape (closed lips stay apart). Solve
// vertices are numbered in the order of their first draw vertex. Triangles that weld to fewer than
// three corners are dropped. Components and bridges are left empty (see bridges.h).
SolveMesh WeldMesh(std::span<const PointMatrix> shapes, std::span<const uint32_t> triangles,
                   double tolerance);

}  // namespace limber::geometry
