#include "geometry/geodesic.h"

#include "core/vector.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace limber::geometry {

EdgeGraph::EdgeGraph(const SolveMesh& mesh) {
  Vector<std::array<int, 2>> edges;
  edges.reserve(6 * mesh.triangles.size() + 2 * mesh.bridges.size());
  const auto add = [&edges](int a, int b) {
    edges.push_back({a, b});
    edges.push_back({b, a});
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    add(a, b);
    add(b, c);
    add(c, a);
  }
  for (const Bridge& bridge : mesh.bridges)
    add(bridge.a, bridge.b);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  first_.assign(static_cast<size_t>(mesh.num_vertices()) + 1, 0);
  for (const auto& [a, b] : edges) {
    ++first_[a + 1];
    neighbour_.push_back(b);
    length_.push_back((mesh.shapes[0].row(a) - mesh.shapes[0].row(b)).norm());
  }
  for (size_t v = 1; v < first_.size(); ++v)
    first_[v] += first_[v - 1];
}

Eigen::VectorXd EdgeGraph::Distances(std::span<const int> sources) const {
  Eigen::VectorXd distance =
      Eigen::VectorXd::Constant(num_vertices(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, Vector<Entry>, std::greater<>> queue;
  for (const int source : sources) {
    distance(source) = 0;
    queue.emplace(0, source);
  }
  while (!queue.empty()) {
    const auto [reached, v] = queue.top();
    queue.pop();
    if (reached > distance(v)) continue;
    for (int e = first_[v]; e < first_[v + 1]; ++e) {
      const double through = reached + length_[e];
      if (through < distance(neighbour_[e])) {
        distance(neighbour_[e]) = through;
        queue.emplace(through, neighbour_[e]);
      }
    }
  }
  return distance;
}

namespace {

// A path counts as shorter only from here on, so that rounding cannot keep the search busy.
constexpr double kLeastGain = 1e-9;

// Distance of a triangle's third corner, as the crow flies over a side of which the distances of
// both ends a and b from a source are known; infinite where that line passes beside it. In the
// triangle's plane a is the origin, b at (side, 0), the corner at (corner_x, corner_y) above and
// the source below.
double ThroughSide(double side, double corner_x, double corner_y, double from_a, double from_b) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!(side > 0) || !(from_b < kNone)) return kNone;
  const double source_x = (from_a * from_a - from_b * from_b + side * side) / (2 * side);
  const double depth_squared = from_a * from_a - source_x * source_x;
  if (!(depth_squared >= 0)) return kNone;
  const double depth = std::sqrt(depth_squared);
  const double height = depth + corner_y;
  const double crossing = height > 0 ? source_x + (corner_x - source_x) * depth / height : source_x;
  if (crossing < 0 || crossing > side) return kNone;
  return std::sqrt((corner_x - source_x) * (corner_x - source_x) + height * height);
}

}  // namespace

SurfaceDistance::SurfaceDistance(const SolveMesh& mesh, int shape)
    : mesh_(mesh),
      points_(mesh.shapes[shape]),
      first_(static_cast<size_t>(mesh.num_vertices()) + 1, 0),
      fan_(3 * mesh.triangles.size()),
      bridged_(static_cast<size_t>(mesh.num_vertices())) {
  flat_.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles)
    flat_.push_back(Flatten(triangle));
  for (const auto& triangle : mesh.triangles) {
    for (const int v : triangle)
      ++first_[v + 1];
  }
  for (size_t v = 1; v < first_.size(); ++v)
    first_[v] += first_[v - 1];
  Vector<int> next(first_.begin(), first_.end() - 1);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const int v : mesh.triangles[t])
      fan_[next[v]++] = static_cast<int>(t);
  }
  for (const Bridge& bridge : mesh.bridges) {
    bridged_[bridge.a].push_back(bridge.b);
    bridged_[bridge.b].push_back(bridge.a);
  }
}

SurfaceDistance::FlatTriangle SurfaceDistance::Flatten(const std::array<int, 3>& triangle) const {
  FlatTriangle flat;
  for (size_t corner = 0; corner < 3; ++corner) {
    const Eigen::RowVector3d a = points_.row(triangle[(corner + 1) % 3]);
    const Eigen::RowVector3d along = points_.row(triangle[(corner + 2) % 3]) - a;
    const Eigen::RowVector3d up = points_.row(triangle[corner]) - a;
    Side& side = flat[corner];
    side.length = along.norm();
    if (!(side.length > 0)) continue;
    side.corner_x = up.dot(along) / side.length;
    side.corner_y = along.cross(up).norm() / side.length;
  }
  return flat;
}

Eigen::VectorXd SurfaceDistance::From(int source) const {
  Eigen::VectorXd distance =
      Eigen::VectorXd::Constant(points_.rows(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, Vector<Entry>, std::greater<>> queue;
  const auto reach = [&](int v, double through) {
    if (!(through < (1 - kLeastGain) * distance(v))) return;
    distance(v) = through;
    queue.emplace(through, v);
  };
  reach(source, 0);
  while (!queue.empty()) {
    const double reached = queue.top().first;
    const int v = queue.top().second;
    queue.pop();
    if (reached > distance(v)) continue;
    for (const int other : bridged_[v])
      reach(other, reached + (points_.row(v) - points_.row(other)).norm());
    for (int i = first_[v]; i < first_[v + 1]; ++i) {
      const std::array<int, 3>& triangle = mesh_.triangles[fan_[i]];
      const FlatTriangle& flat = flat_[fan_[i]];
      const int at = triangle[0] == v ? 0 : triangle[1] == v ? 1 : 2;
      const int b = at == 2 ? 0 : at + 1, c = at == 0 ? 2 : at - 1;
      const double along_b = reached + flat[c].length, along_c = reached + flat[b].length;
      const double from_b = std::min(distance(triangle[b]), along_b);
      const double from_c = std::min(distance(triangle[c]), along_c);
      // The side opposite c begins at v, the one opposite b ends there.
      const double over_b =
          ThroughSide(flat[c].length, flat[c].corner_x, flat[c].corner_y, reached, from_b);
      const double over_c = ThroughSide(flat[b].length, flat[b].length - flat[b].corner_x,
                                        flat[b].corner_y, reached, from_c);
      reach(triangle[b], std::min(along_b, over_c));
      reach(triangle[c], std::min(along_c, over_b));
    }
  }
  return distance;
}

}  // namespace limber::geometry
