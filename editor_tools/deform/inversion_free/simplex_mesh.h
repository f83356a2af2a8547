// Triangles in the plane or tetrahedra in space, and how their corners' positions make their
// deformation gradients.
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <Eigen/Core>

#include <array>

namespace limber::deform {

// D = 2: triangles, counter-clockwise; D = 3: tetrahedra whose first three corners run
// counter-clockwise as seen from the fourth. So every volume at rest is positive.
template <int D>
struct SimplexMesh {
  using Positions = Eigen::Matrix<double, Eigen::Dynamic, D, Eigen::RowMajor>;
  using Element = std::array<int, D + 1>;

  Positions rest;  // [V]
  Vector<Element> elements;

  int num_vertices() const { return static_cast<int>(rest.rows()); }

  int num_elements() const { return static_cast<int>(elements.size()); }
};

using TriangleMesh = SimplexMesh<2>;
using TetMesh = SimplexMesh<3>;

// One element at rest. With the corners' positions as columns of X, F = X gradients^T.
template <int D>
struct ElementRest {
  Eigen::Matrix<double, D, D + 1> gradients;  // of the corners' linear shape functions
  double volume = 0;                          // or area
};

// Of every element. Errors: kDegenerate (no element; one that is flat or inside out at rest:
// `Orient` mends the latter), kMalformed (a corner that is none, a position that is not finite),
// with its number.
template <int D>
Result<Vector<ElementRest<D>>> MeasureRest(const SimplexMesh<D>& mesh);

// Swaps two corners of each element that is inside out. Returns how many there were.
template <int D>
int Orient(SimplexMesh<D>* mesh);

// D! times the signed volume.
template <int D>
double SignedSize(const typename SimplexMesh<D>::Positions& positions,
                  const typename SimplexMesh<D>::Element& element);

// The corners' positions as columns.
template <int D>
Eigen::Matrix<double, D, D + 1> Corners(const typename SimplexMesh<D>::Positions& positions,
                                        const typename SimplexMesh<D>::Element& element) {
  Eigen::Matrix<double, D, D + 1> corners;
  for (int a = 0; a <= D; ++a)
    corners.col(a) = positions.row(element[static_cast<size_t>(a)]).transpose();
  return corners;
}

}  // namespace limber::deform
