// Small welded meshes made in code, and the maps that the invariance tests put them through.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <array>
#include <cstdint>

namespace limber::test {

using geometry::PointMatrix;
using geometry::SolveMesh;

// columns x rows squares of two triangles each over [0, columns] x [0, rows] in the xy plane;
// vertex y * (columns + 1) + x lies at (x, y, 0).
SolveMesh MakeGrid(int columns, int rows);

// A closed surface around the origin, wavy and without symmetry, about 2 large: `rings` circles of
// `around` vertices between two poles (the last two vertices).
SolveMesh MakeBlob(int around, int rings);

// `part` put beside `mesh` as further components, each shape of it moved by `offset`.
void Append(const SolveMesh& part, const Eigen::RowVector3d& offset, SolveMesh* mesh);

// A repeatable shuffle of 0..count-1.
Vector<int> Shuffle(int count, uint32_t seed);

// The same mesh with vertex v renamed to order[v]; bridges and components follow.
SolveMesh Renumbered(const SolveMesh& mesh, const Vector<int>& order);

}  // namespace limber::test
