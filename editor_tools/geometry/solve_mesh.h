// The welded mesh that weights, edge groups and tensors are computed on (geometry shared by bake
// and deform). Plain data; made by WeldMesh (weld.h) and ConnectComponents (bridges.h).
#pragma once

#include "core/vector.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace limber::geometry {

using PointMatrix = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

// An artificial edge that ties a component (an eye, a tooth) to its neighbour, so that it follows
// and no system is singular. `weight` stands beside cotangent weights.
struct Bridge {
  int a = 0, b = 0;  // solve vertices: of the part that is tied, and of what it is tied to
  double weight = 0;
};

struct SolveMesh {
  Vector<PointMatrix> shapes;            // S of V x 3
  Vector<std::array<int, 3>> triangles;  // solve vertices; none repeats a corner
  Vector<uint32_t> solve_vertex;         // draw vertex -> solve vertex
  Vector<int> component;                 // [V], 0 is the largest component
  int num_components = 0;
  Vector<Bridge> bridges;

  int num_vertices() const { return shapes.empty() ? 0 : static_cast<int>(shapes[0].rows()); }

  int num_shapes() const { return static_cast<int>(shapes.size()); }
};

// One term of the elastic energy (eq. 9): edge (i, j) in group g with weight c_ge. With spokes and
// rims an edge near a border belongs to several groups.
struct GroupEdge {
  int group = 0;
  int i = 0, j = 0;
  double weight = 0;  // c_ge > 0
};

}  // namespace limber::geometry
