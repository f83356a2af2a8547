#include "geometry/extremities.h"

#include "core/vector.h"
#include "geometry/geodesic.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace limber::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A handle on every tooth is of no use: parts of a smaller share of all vertices are left out.
constexpr double kSmallestPart = 0.02;
constexpr int kNumLandmarks = 32;
// A tip is the most remote vertex within this fraction of the surface's largest distance: a hand
// has one tip, not five.
constexpr double kTipRadius = 0.1;
constexpr size_t kMaxTipCandidates = 96;
// Tips come before ordinary vertices that are up to this factor farther from what is chosen.
constexpr double kTipPreference = 2.5;

// Two points count as no farther apart than this many times the straight distance: the inside of a
// mouth or of a sleeve is far by the surface, yet of no use beside a handle outside.
constexpr double kLargestDetour = 3;

int Farthest(const Vector<int>& candidates, const Eigen::VectorXd& distance) {
  return *std::max_element(candidates.begin(), candidates.end(),
                           [&](int a, int b) { return distance(a) < distance(b); });
}

Vector<int> EligibleVertices(const SolveMesh& mesh) {
  const auto num_vertices = static_cast<size_t>(mesh.num_vertices());
  Vector<bool> has_triangle(num_vertices, false);
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (const int v : triangle)
      has_triangle[static_cast<size_t>(v)] = true;
  }
  const bool has_components = !mesh.component.empty();
  Vector<int> part_size(static_cast<size_t>(std::max(mesh.num_components, 1)), 0);
  const auto part = [&](size_t v) {
    return has_components ? static_cast<size_t>(mesh.component[v]) : 0;
  };
  for (size_t v = 0; v < num_vertices; ++v)
    ++part_size[part(v)];
  Vector<int> eligible;
  for (size_t v = 0; v < num_vertices; ++v) {
    const bool is_large = part(v) == 0 || part_size[part(v)] >= kSmallestPart * mesh.num_vertices();
    if (has_triangle[v] && is_large) eligible.push_back(static_cast<int>(v));
  }
  return eligible;
}

struct Remoteness {
  Eigen::VectorXd mean_distance;  // [V] to the eligible vertices
  double size = 0;                // the largest distance met
};

// Landmarks spread over the surface stand each for the vertices nearest to them.
Remoteness MeasureRemoteness(const EdgeGraph& graph, const Vector<int>& eligible) {
  Eigen::VectorXd spacing = Eigen::VectorXd::Constant(graph.num_vertices(), kInfinity);
  Vector<size_t> nearest(static_cast<size_t>(graph.num_vertices()), 0);
  Vector<Eigen::VectorXd> distances;
  int landmark = eligible[0];
  while (distances.size() < kNumLandmarks) {
    distances.push_back(graph.Distances(std::array{landmark}));
    for (const int v : eligible) {
      if (distances.back()(v) < spacing(v)) nearest[v] = distances.size() - 1;
    }
    spacing = spacing.cwiseMin(distances.back());
    landmark = Farthest(eligible, spacing);
    if (!(spacing(landmark) > 0)) break;
  }
  Eigen::VectorXd share = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(distances.size()));
  for (const int v : eligible)
    share(static_cast<Eigen::Index>(nearest[v])) += 1;
  Remoteness result{Eigen::VectorXd::Zero(graph.num_vertices()), 0};
  for (size_t i = 0; i < distances.size(); ++i) {
    result.mean_distance += share(static_cast<Eigen::Index>(i)) * distances[i];
    for (const int v : eligible) {
      if (std::isfinite(distances[i](v))) result.size = std::max(result.size, distances[i](v));
    }
  }
  result.mean_distance /= static_cast<double>(eligible.size());
  return result;
}

// Of equally remote vertices the first counts as the more remote one.
bool MoreRemote(const Eigen::VectorXd& remoteness, int a, int b) {
  return remoteness(a) != remoteness(b) ? remoteness(a) > remoteness(b) : a < b;
}

// Whether the surface at a peak faces away from the middle of what lies around it (within `radius`
// by the surface). It does at the end of a limb; at the bottom of a pocket it faces back.
bool PointsOutwards(const SolveMesh& mesh, int peak, const Eigen::VectorXd& distance,
                    double radius) {
  const PointMatrix& points = mesh.shapes[0];
  Eigen::RowVector3d normal = Eigen::RowVector3d::Zero(), middle = normal;
  for (const auto& [a, b, c] : mesh.triangles) {
    if (a != peak && b != peak && c != peak) continue;
    normal += (points.row(b) - points.row(a)).cross(points.row(c) - points.row(a));
  }
  double count = 0;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (distance(v) > radius) continue;
    middle += points.row(v);
    count += 1;
  }
  const Eigen::RowVector3d outwards = points.row(peak) - middle / count;
  // Flat characters face sideways everywhere: only a clear turn backwards counts.
  return normal.dot(outwards) >= -0.2 * normal.norm() * outwards.norm();
}

Vector<int> FindTips(const SolveMesh& mesh, const EdgeGraph& graph, const Vector<int>& eligible,
                     const Remoteness& remoteness) {
  const auto more_remote = [&](int a, int b) { return MoreRemote(remoteness.mean_distance, a, b); };
  Vector<int> peaks;
  for (const int v : eligible) {
    const auto neighbours = graph.Neighbours(v);
    if (std::none_of(neighbours.begin(), neighbours.end(),
                     [&](int other) { return more_remote(other, v); })) {
      peaks.push_back(v);
    }
  }
  std::sort(peaks.begin(), peaks.end(), more_remote);
  if (peaks.size() > kMaxTipCandidates) peaks.resize(kMaxTipCandidates);
  Vector<int> tips;
  for (const int peak : peaks) {
    const Eigen::VectorXd distance = graph.Distances(std::array{peak});
    const double radius = kTipRadius * remoteness.size;
    const bool is_highest = std::none_of(eligible.begin(), eligible.end(), [&](int v) {
      return distance(v) < radius && more_remote(v, peak);
    });
    if (is_highest && PointsOutwards(mesh, peak, distance, radius)) tips.push_back(peak);
  }
  return tips;
}

// Distance of every vertex from `vertex`, for the spreading.
Eigen::VectorXd SpreadDistance(const SolveMesh& mesh, const EdgeGraph& graph, int vertex) {
  const PointMatrix& points = mesh.shapes[0];
  const Eigen::VectorXd straight = (points.rowwise() - points.row(vertex)).rowwise().norm();
  return graph.Distances(std::array{vertex}).cwiseMin(kLargestDetour * straight);
}

}  // namespace

Vector<int> SpreadPoints(const SolveMesh& mesh, int count) {
  Vector<int> chosen;
  const Vector<int> eligible = EligibleVertices(mesh);
  if (eligible.empty() || count < 1) return chosen;
  const EdgeGraph graph(mesh);
  const Remoteness remoteness = MeasureRemoteness(graph, eligible);
  const Vector<int> tips = FindTips(mesh, graph, eligible, remoteness);

  chosen.push_back(tips.empty() ? eligible[0] : tips[0]);
  Eigen::VectorXd spacing = SpreadDistance(mesh, graph, chosen[0]);
  while (chosen.size() < static_cast<size_t>(count)) {
    int next = Farthest(eligible, spacing);
    if (!tips.empty()) {
      const int tip = Farthest(tips, spacing);
      if (kTipPreference * spacing(tip) >= spacing(next)) next = tip;
    }
    if (!(spacing(next) > 0)) break;
    chosen.push_back(next);
    spacing = spacing.cwiseMin(SpreadDistance(mesh, graph, next));
  }
  return chosen;
}

}  // namespace limber::geometry
