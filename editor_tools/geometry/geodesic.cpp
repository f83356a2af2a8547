#include "geometry/geodesic.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace limber::geometry {

EdgeGraph::EdgeGraph(const SolveMesh& mesh) {
  std::vector<std::array<int, 2>> edges;
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
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
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

}  // namespace limber::geometry
