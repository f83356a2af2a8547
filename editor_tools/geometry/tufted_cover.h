// A closed manifold over any triangle soup: the tufted cover, with edge lengths that bound real
// triangles.
#pragma once

#include "core/vector.h"
#include "geometry/intrinsic_triangulation.h"
#include "geometry/solve_mesh.h"

#include <array>
#include <span>

namespace limber::geometry {

// Sides of a triangle satisfy the triangle inequality by at least this, of the mean side length.
inline constexpr double kMollification = 1e-5;

// [T] lengths of the triangles' sides (side i from corner i to the next) in units of their mean,
// all lengthened by the least common amount after which every triangle satisfies the triangle
// inequality by kMollification (the intrinsic mollification of Sharp and Crane 2020): nothing
// changes where no triangle is a needle or a cap, and none has a zero side or zero area afterwards.
struct SideLengths {
  Vector<std::array<double, 3>> sides;
  double unit = 1;  // the mean, mesh units; one where it is zero, and then all sides are equal
};

SideLengths MollifiedLengths(const PointMatrix& points,
                             std::span<const std::array<int, 3>> triangles);

// The tufted cover (Sharp and Crane 2020): each triangle twice, its front as face 2 t, its back as
// face 2 t + 1, glued around every edge of the mesh from each triangle to the next by dihedral
// angle, the side that looks ahead to the side that looks back. A side on a border is glued to the
// back of its own triangle, so the cover has no border; around an edge of two triangles their
// fronts meet and their backs meet, whichever way they are wound. Copies of one triangle lie one
// upon the other, in the order of their numbers, alike at all three sides. Where other triangles
// leave an edge in the same direction any order is valid, and that of their third corners decides.
// Vertices are those of the mesh. Triangles need three distinct corners, finite points, and number
// at most 2^31 / 6.
IntrinsicTriangulation TuftedCover(const PointMatrix& points,
                                   std::span<const std::array<int, 3>> triangles,
                                   const SideLengths& lengths);

}  // namespace limber::geometry
