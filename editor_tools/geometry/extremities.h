// Points spread over a surface, extremities first.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

namespace limber::geometry {

// Up to `count` distinct solve vertices of the first shape in the order of choice: farthest-point
// sampling by distance along edges and bridges (capped by the straight distance, so that pockets do
// not count as far), beginning at the most remote tip, in which tips
// (hands, feet, head, tail: local maxima of the mean distance to everything else) come before
// ordinary vertices. Only corners of triangles, and only on components that hold at least 2 % of
// the vertices. Deterministic.
// Fewer come back only where the surface has no more distinct points.
Vector<int> SpreadPoints(const SolveMesh& mesh, int count);

}  // namespace limber::geometry
