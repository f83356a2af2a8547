// A Laplacian that is sound on any triangle soup: Sharp and Crane 2020, A Laplacian for Nonmanifold
// Triangle Meshes.
//
// The triangles, with edge lengths that bound real triangles (mollified), are covered twice by a
// closed manifold (the tufted cover), and the cover's edges are flipped until all are Delaunay.
// Of that triangulation, with angles a and b opposite the edge from i to j,
//   w_ij = 1/2 (cot a + cot b) >= 0,   (L u)_i = 1/2 sum_j w_ij (u_i - u_j),
// where the leading half is for the two sheets, and several edges between i and j add up. So
//   u^T L u = 1/2 sum over edges of w_ij (u_i - u_j)^2 = 1/2 integral over the cover of |grad u|^2
// for u linear in each intrinsic triangle. From this follow:
// - No off-diagonal entry is positive, so harmonic functions obey the maximum principle: they stay
//   within their boundary values.
// - The kernel is the functions that are constant on each part connected through triangles, however
//   many weights are zero: intrinsic triangles have area, so an energy of zero means a gradient of
//   zero in each. Weights need no lower bound. What is clamped below is rounding, negative weights
//   of cocircular corners, and clamping those to zero only adds to the energy.
// - Winding, and which diagonal cuts a planar cocircular quadrilateral, do not matter.
// - Where the mesh is manifold without border and Delaunay, L is the cotangent Laplacian; where all
//   edges of the cover are Delaunay it is the sum of the triangles' cotangent matrices. Flips only
//   lower the energy (Rippa 1990).
// Areas are those of the intrinsic Voronoi cells, area_i = 1/8 sum_j w_ij length_ij^2 over the
// edges of the cover: positive on a Delaunay triangulation, together the area of the mesh, and, as
// barycentric areas are not, the same for either diagonal of a cocircular quadrilateral.
#pragma once

#include "geometry/solve_mesh.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cstdint>

namespace limber::geometry {

struct RobustLaplacian {
  // V x V, symmetric positive semi-definite, row sums zero, off-diagonals <= 0; no unit.
  Eigen::SparseMatrix<double> laplacian;
  Eigen::VectorXd areas;  // V, all positive, mesh units squared
  // False where edges were left that are not Delaunay, as too many flips had been made: all of the
  // above holds still, but linear functions are not reproduced around those edges.
  bool is_delaunay = true;
};

// NOTE two liberties, for the condition of the systems built on the weights; neither touches the
// properties above but where it applies, the exactness of linear functions.
// Weights of the cover are clamped from above to this. Two vertices that all but coincide (seen
// from the next ones, under less than half a degree) move as one either way.
inline constexpr double kLargestWeight = 100;
// A vertex whose weights sum to less than this has them raised to it: a tip of needles or a strip a
// hundred times as long as wide, where the surface is next to nothing but what hangs on it is not.
// (At any other vertex the sum is of the order of its angle: a Voronoi edge at distance h seen
// under the angle t is at least h t long.) Otherwise a vertex hung by a mollified triangle only
// would be held by a hundred-thousandth of what holds the others.
inline constexpr double kSmallestHold = 1e-2;

// For MakeRobustLaplacian: many times what meshes need, which is less than one flip an edge, or for
// few triangles as many as they are longer than wide.
inline constexpr int64_t kEnoughFlips = -1;

// Of the first shape, whose triangles may be anything: triangles that repeat a corner or have one
// that is not finite count as absent. Bridges add their weights as given. Vertices whose area is
// below a small fraction of the mean get that. Depends on the order of vertices and triangles, on
// rigid motions and on scale by rounding only, except as TuftedCover says. max_flips bounds the
// time.
RobustLaplacian MakeRobustLaplacian(const SolveMesh& mesh, int64_t max_flips = kEnoughFlips);

}  // namespace limber::geometry
