// How far apart handles can be without stretching any example.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <span>

namespace limber::bake {

// H*H, row-major and symmetric, in mesh units divided by `scale`: for each pair of handles the
// length of the shortest path over the surface between their vertices (geometry/geodesic.h), the
// largest over the shapes; zero on the diagonal and where no path leads. Never less than the
// straight distance between the two in any shape. handle_vertices: H solve vertices.
// num_threads <= 0: one per core; the result has the same bits for any number.
Vector<float> HandleReach(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices,
                          double scale, int num_threads);

}  // namespace limber::bake
