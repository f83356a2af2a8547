// Distances along the surface, bridges included: over its edges, and over its triangles.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

#include <array>
#include <span>

namespace limber::geometry {

// Shortest paths along edges, on the first shape: longer than those over the surface by up to a
// sixth, more where triangles are long.
class EdgeGraph {
 public:
  explicit EdgeGraph(const SolveMesh& mesh);

  int num_vertices() const { return static_cast<int>(first_.size()) - 1; }

  // Length of the shortest path from the nearest of `sources` (solve vertices), mesh units;
  // infinite where none leads. V.
  Eigen::VectorXd Distances(std::span<const int> sources) const;

  // Neighbours of a vertex, ascending.
  std::span<const int> Neighbours(int vertex) const {
    return {neighbour_.data() + first_[vertex], neighbour_.data() + first_[vertex + 1]};
  }

 private:
  Vector<int> first_;  // V + 1 offsets into the two below
  Vector<int> neighbour_;
  Vector<double> length_;
};

// Lengths of shortest paths through the triangles of any one of the shapes. From the distances of
// two corners the source is unfolded into the triangle's plane and gives the third corner's
// (Novotni and Klein 2002, Computing geodesic distances on triangular meshes), until nothing
// shortens. So lengths are those of straight lines where the way unfolds to a plane: on flat
// pieces, cylinders and cones to rounding. Elsewhere the error shrinks as the size of the
// triangles: on a sphere of n meridians lengths come out short, by up to 0.65 / n of themselves
// within a quarter of the way round and 2.2 / n beyond.
class SurfaceDistance {
 public:
  // The mesh must outlive this; shape in [0, S).
  SurfaceDistance(const SolveMesh& mesh, int shape);

  // From one solve vertex to all, mesh units; infinite where no path leads. V.
  Eigen::VectorXd From(int source) const;

 private:
  // A side with the corner opposite to it, in the triangle's plane: the side's first end is the
  // origin, its other end on the x axis.
  struct Side {
    double length = 0, corner_x = 0, corner_y = 0;
  };

  using FlatTriangle = std::array<Side, 3>;  // side i from corner i + 1 to i + 2

  FlatTriangle Flatten(const std::array<int, 3>& triangle) const;

  const SolveMesh& mesh_;
  const PointMatrix& points_;
  Vector<FlatTriangle> flat_;    // [T]
  Vector<int> first_;            // V + 1 offsets into the next
  Vector<int> fan_;              // triangles at each vertex, ascending
  Vector<Vector<int>> bridged_;  // other ends of the bridges at each vertex
};

}  // namespace limber::geometry
