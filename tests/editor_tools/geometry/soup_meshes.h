// Meshes that are hard on a Laplacian, made in code, and their plain cotangent matrix.
#pragma once

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace limber::test {

// The unit sphere of 10 * 4^n + 2 vertices: an icosahedron with each triangle cut in four n times.
// All triangles are acute.
SolveMesh MakeIcosphere(int num_subdivisions);

// The unit square of n x n cells, inner vertices moved at random by up to 0.3 of a cell, so that
// the Delaunay triangulation keeps all border edges.
SolveMesh MakeJitteredSquare(int n, uint32_t seed);

// The flat mesh with edges at random replaced by the other diagonal where that leaves both
// triangles the right way up and at least a hundredth as high as long: the same vertices and
// outline, needles of all but the thinnest kind.
SolveMesh RandomlyFlipped(const SolveMesh& flat, int num_tries, uint32_t seed);

// Pages of 2 x 3 cells around a common spine, at uneven angles in all directions; no angle of any
// triangle is obtuse.
SolveMesh MakeBook(int num_pages);

// Triangles between any three of the vertices, which are points at random: edges of many
// triangles, triangles through one another, vertices where they only touch.
SolveMesh MakeSoup(int num_vertices, int num_triangles, uint32_t seed);

// Adds what modellers leave behind: copies of triangles, some wound the other way, triangles with
// corners in line and with corners in one place, a flap on an inner edge, a loose vertex.
void Spoil(uint32_t seed, SolveMesh* mesh);

// The sum of the triangles' cotangent matrices, dense, by the definition: nothing is clamped.
Eigen::MatrixXd SummedCotangents(const SolveMesh& mesh);

// The same mesh with its triangles in another order, each wound the other way or not and begun
// at another corner.
SolveMesh Rewound(const SolveMesh& mesh, uint32_t seed);

// Solves laplacian u = right_side where v is not fixed, u = fixed_values where it is.
Eigen::VectorXd SolveWithFixed(const Eigen::MatrixXd& laplacian, const Eigen::VectorXd& right_side,
                               const Vector<bool>& is_fixed, const Eigen::VectorXd& fixed_values);

// The vertices of a mesh over the unit square that lie on its outline.
Vector<bool> OnOutline(const SolveMesh& mesh);

}  // namespace limber::test
