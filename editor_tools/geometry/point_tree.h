// A kd-tree over some of the points of a mesh, for nearest-point queries.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

namespace limber::geometry {

// 0, 1, ... count - 1: a tree over all the points.
Vector<int> AllIndices(int count);

class PointTree {
 public:
  // Over the rows `indices` of `points`; `points` must outlive the tree.
  PointTree(const PointMatrix& points, Vector<int> indices);

  // Lowers *squared_distance and sets *nearest (a row of `points`) if some point is strictly nearer
  // to x than *squared_distance, or as near and of a smaller index than a *nearest >= 0: the answer
  // does not depend on the tree.
  void FindNearest(const Eigen::Vector3d& x, double* squared_distance, int* nearest) const;

 private:
  struct Node {
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;  // bounding box of its points
    int begin = 0, end = 0;                                     // points, a range of indices_
    int children = -1;  // first of two neighbouring nodes, -1 for a leaf
  };

  void Split(int node_index);
  void Visit(int node_index, const Eigen::Vector3d& x, double* squared_distance,
             int* nearest) const;

  const PointMatrix& points_;
  Vector<int> indices_;
  Vector<Node> nodes_;
};

}  // namespace limber::geometry
