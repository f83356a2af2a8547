#include "geometry/point_tree.h"

#include "core/vector.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace limber::geometry {
namespace {

constexpr int kLeafSize = 12;

double SquaredDistanceToBox(const Eigen::Vector3d& x, const Eigen::Vector3d& low,
                            const Eigen::Vector3d& high) {
  return (low - x).cwiseMax(x - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Vector<int> AllIndices(int count) {
  Vector<int> indices(static_cast<size_t>(count));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

PointTree::PointTree(const PointMatrix& points, Vector<int> indices)
    : points_(points),
      indices_(std::move(indices)) {
  if (indices_.empty()) return;
  Node root;
  root.end = static_cast<int>(indices_.size());
  nodes_.push_back(root);
  // Breadth first: splitting appends, so the loop visits every node once and nothing recurses.
  for (size_t node = 0; node < nodes_.size(); ++node)
    Split(static_cast<int>(node));
}

void PointTree::Split(int node_index) {
  Node node = nodes_[node_index];
  node.low = node.high = points_.row(indices_[node.begin]).transpose();
  for (int i = node.begin; i < node.end; ++i) {
    const Eigen::Vector3d point = points_.row(indices_[i]).transpose();
    node.low = node.low.cwiseMin(point);
    node.high = node.high.cwiseMax(point);
  }
  if (node.end - node.begin > kLeafSize) {
    int axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const int middle = (node.begin + node.end) / 2;
    std::nth_element(indices_.begin() + node.begin, indices_.begin() + middle,
                     indices_.begin() + node.end,
                     [&](int a, int b) { return points_(a, axis) < points_(b, axis); });
    node.children = static_cast<int>(nodes_.size());
    Node left, right;
    left.begin = node.begin;
    left.end = right.begin = middle;
    right.end = node.end;
    nodes_.push_back(left);
    nodes_.push_back(right);
  }
  nodes_[node_index] = node;
}

void PointTree::FindNearest(const Eigen::Vector3d& x, double* squared_distance,
                            int* nearest) const {
  if (!nodes_.empty()) Visit(0, x, squared_distance, nearest);
}

void PointTree::Visit(int node_index, const Eigen::Vector3d& x, double* squared_distance,
                      int* nearest) const {
  const Node& node = nodes_[node_index];
  if (SquaredDistanceToBox(x, node.low, node.high) > *squared_distance) return;
  if (node.children < 0) {
    for (int i = node.begin; i < node.end; ++i) {
      const int candidate = indices_[i];
      const double d = (points_.row(candidate).transpose() - x).squaredNorm();
      const bool tie_won = d == *squared_distance && *nearest >= 0 && candidate < *nearest;
      if (d < *squared_distance || tie_won) {
        *squared_distance = d;
        *nearest = candidate;
      }
    }
    return;
  }
  const Node& left = nodes_[node.children];
  const Node& right = nodes_[node.children + 1];
  const bool left_first = SquaredDistanceToBox(x, left.low, left.high) <=
                          SquaredDistanceToBox(x, right.low, right.high);
  Visit(node.children + (left_first ? 0 : 1), x, squared_distance, nearest);
  Visit(node.children + (left_first ? 1 : 0), x, squared_distance, nearest);
}

}  // namespace limber::geometry
