#include "geometry/bridges.h"

#include "core/vector.h"
#include "geometry/cotangent.h"
#include "geometry/point_tree.h"
#include "geometry/union_find.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace limber::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Parts beyond this many (dust: loose vertices, sprinkles) are tied to the body as it stands after
// the larger parts, rather than to each other: the growing below costs the square of their number.
constexpr int kMaxGrownParts = 2048;
// Bridges start within the smallest gap plus this fraction of the part's size from the body. An
// eyeball is held all around; a sleeve is held at the shoulder but not at the wrist.
constexpr double kReach = 0.2;

// Members of each component, largest component first, ties by the smallest member.
Vector<Vector<int>> FindComponents(const SolveMesh& mesh) {
  const int num_vertices = mesh.num_vertices();
  UnionFind sets(num_vertices);
  for (const auto& triangle : mesh.triangles) {
    sets.Unite(triangle[0], triangle[1]);
    sets.Unite(triangle[0], triangle[2]);
  }
  Vector<int> component_of_root(static_cast<size_t>(num_vertices), -1);
  Vector<Vector<int>> components;
  for (int v = 0; v < num_vertices; ++v) {
    int& component = component_of_root[sets.Find(v)];
    if (component < 0) {
      component = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[component].push_back(v);
  }
  std::stable_sort(components.begin(), components.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return components;
}

int WantedBridges(size_t part_size) {
  return static_cast<int>(std::min<size_t>(part_size, 6 + std::min<size_t>(6, part_size / 100)));
}

// Grows the connected body part by part and remembers for every vertex outside its nearest vertex
// inside.
class Connector {
 public:
  Connector(const PointMatrix& points, const Vector<Vector<int>>& components, double weight)
      : points_(points),
        components_(components),
        weight_(weight),
        nearest_(static_cast<size_t>(points.rows()), -1),
        squared_gap_(static_cast<size_t>(points.rows()), kInfinity) {}

  Vector<Bridge> Run() {
    const size_t num_grown = std::min<size_t>(components_.size(), kMaxGrownParts);
    Vector<int> outside(num_grown - 1);
    std::iota(outside.begin(), outside.end(), 1);
    Include(components_[0], outside);
    while (!outside.empty()) {
      const auto next = std::min_element(outside.begin(), outside.end(), [this](int a, int b) {
        return SmallestGap(components_[a]) < SmallestGap(components_[b]);
      });
      const int part = *next;
      outside.erase(next);
      AddBridges(components_[part]);
      Include(components_[part], outside);
    }
    if (num_grown < components_.size()) TieDust(num_grown);
    return std::move(bridges_);
  }

 private:
  double SmallestGap(const Vector<int>& part) const {
    double smallest = kInfinity;
    for (const int v : part)
      smallest = std::min(smallest, squared_gap_[v]);
    return smallest;
  }

  void Include(const Vector<int>& part, const Vector<int>& outside) {
    const PointTree tree(points_, part);
    for (const int other : outside) {
      for (const int v : components_[other]) {
        tree.FindNearest(points_.row(v).transpose(), &squared_gap_[v], &nearest_[v]);
      }
    }
  }

  void TieDust(size_t first) {
    Vector<int> body, dust(components_.size() - first);
    for (size_t c = 0; c < first; ++c) {
      body.insert(body.end(), components_[c].begin(), components_[c].end());
    }
    std::iota(dust.begin(), dust.end(), static_cast<int>(first));
    Include(body, dust);
    for (const int part : dust)
      AddBridges(components_[part]);
  }

  // The part's vertices that lie close enough to the body to be tied to it.
  Vector<int> Candidates(const Vector<int>& part, int wanted) const {
    Vector<int> sorted = part;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [this](int a, int b) { return squared_gap_[a] < squared_gap_[b]; });
    Eigen::RowVector3d low = points_.row(part[0]), high = low;
    for (const int v : part) {
      low = low.cwiseMin(points_.row(v));
      high = high.cwiseMax(points_.row(v));
    }
    const double reach = std::sqrt(squared_gap_[sorted[0]]) + kReach * (high - low).norm();
    const auto end = std::find_if(sorted.begin(), sorted.end(),
                                  [&](int v) { return std::sqrt(squared_gap_[v]) > reach; });
    const auto within = static_cast<size_t>(end - sorted.begin());
    sorted.resize(std::min(sorted.size(), std::max<size_t>(within, 2 * size_t(wanted))));
    return sorted;
  }

  // Farthest-point sampling of the candidates, from the one nearest to the body.
  void AddBridges(const Vector<int>& part) {
    const int wanted = WantedBridges(part.size());
    const Vector<int> candidates = Candidates(part, wanted);
    Vector<double> spacing(candidates.size(), kInfinity);
    size_t chosen = 0;
    for (int count = 0; count < wanted; ++count) {
      const int v = candidates[chosen];
      bridges_.push_back({v, nearest_[v], weight_});
      for (size_t i = 0; i < candidates.size(); ++i) {
        spacing[i] =
            std::min(spacing[i], (points_.row(candidates[i]) - points_.row(v)).squaredNorm());
      }
      spacing[chosen] = -1;  // never twice, even where all candidates coincide
      chosen =
          static_cast<size_t>(std::max_element(spacing.begin(), spacing.end()) - spacing.begin());
    }
  }

  const PointMatrix& points_;
  const Vector<Vector<int>>& components_;
  const double weight_;
  Vector<int> nearest_;
  Vector<double> squared_gap_;
  Vector<Bridge> bridges_;
};

// The mean edge weight: a bridge then pulls like one ordinary edge of the surface. A handful of
// them holds six degrees of freedom firmly, while the body's vertex at the other end, which has
// about six edges of its own, hardly notices.
double BridgeWeight(const SolveMesh& mesh) {
  const Vector<WeightedEdge> edges = CotangentEdges(mesh);
  if (edges.empty()) return 1;
  double sum = 0;
  for (const WeightedEdge& edge : edges)
    sum += edge.weight;
  return sum / static_cast<double>(edges.size());
}

}  // namespace

void ConnectComponents(SolveMesh* mesh) {
  mesh->bridges.clear();
  mesh->component.assign(static_cast<size_t>(mesh->num_vertices()), 0);
  const Vector<Vector<int>> components = FindComponents(*mesh);
  mesh->num_components = static_cast<int>(components.size());
  for (size_t c = 0; c < components.size(); ++c) {
    for (const int v : components[c])
      mesh->component[v] = static_cast<int>(c);
  }
  if (components.size() < 2) return;
  mesh->bridges = Connector(mesh->shapes[0], components, BridgeWeight(*mesh)).Run();
}

}  // namespace limber::geometry
