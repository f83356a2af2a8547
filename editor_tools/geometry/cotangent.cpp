#include "geometry/cotangent.h"

#include "core/vector.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace limber::geometry {
namespace {

// Angles below about half a degree count as half a degree: one needle must not outweigh its
// hundred neighbours, nor ruin the condition of every system built on these weights.
constexpr double kLargestCotangent = 100;
constexpr double kEquilateralCotangent = 0.5773502691896258;
constexpr double kSmallestArea = 1e-4;  // of the mean vertex area

std::array<double, 3> Cotangents(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& c) {
  Eigen::Vector3d edges[3] = {c - b, a - c, b - a};  // edge i is opposite corner i
  double longest = 0;
  for (const Eigen::Vector3d& edge : edges) {
    longest = std::max(longest, edge.lpNorm<Eigen::Infinity>());
  }
  if (!(longest > 0) || !std::isfinite(longest)) {
    return {kEquilateralCotangent, kEquilateralCotangent, kEquilateralCotangent};
  }
  for (Eigen::Vector3d& edge : edges)
    edge /= longest;  // squares neither overflow nor vanish
  const double twice_area = std::max(edges[0].cross(edges[1]).norm(), 1e-12);
  std::array<double, 3> cotangents{};
  for (int i = 0; i < 3; ++i) {
    const double dot = -edges[(i + 1) % 3].dot(edges[(i + 2) % 3]);
    cotangents[i] = std::clamp(dot / twice_area, -kLargestCotangent, kLargestCotangent);
  }
  return cotangents;
}

bool Before(const WeightedEdge& a, const WeightedEdge& b) {
  return std::pair(a.i, a.j) < std::pair(b.i, b.j);
}

}  // namespace

Vector<std::array<double, 3>> CornerCotangents(const SolveMesh& mesh) {
  Vector<std::array<double, 3>> cotangents;
  cotangents.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const PointMatrix& points = mesh.shapes[0];
    cotangents.push_back(Cotangents(points.row(a), points.row(b), points.row(c)));
  }
  return cotangents;
}

Vector<WeightedEdge> CotangentEdges(const SolveMesh& mesh) {
  const Vector<std::array<double, 3>> cotangents = CornerCotangents(mesh);
  Vector<WeightedEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int i = mesh.triangles[t][(corner + 1) % 3], j = mesh.triangles[t][(corner + 2) % 3];
      edges.push_back({std::min(i, j), std::max(i, j), 0.5 * cotangents[t][corner]});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), Before);
  size_t count = 0;
  for (const WeightedEdge& edge : edges) {
    if (count > 0 && edges[count - 1].i == edge.i && edges[count - 1].j == edge.j) {
      edges[count - 1].weight += edge.weight;
    } else {
      edges[count++] = edge;
    }
  }
  edges.resize(count);
  double sum = 0;
  for (const WeightedEdge& edge : edges)
    sum += std::abs(edge.weight);
  // The sum is zero for right-angled meshes of one triangle at most: then any positive size will
  // do.
  const double mean = sum > 0 ? sum / static_cast<double>(count) : 1;
  for (WeightedEdge& edge : edges)
    edge.weight = std::max(edge.weight, kSmallestEdgeWeight * mean);
  return edges;
}

Eigen::SparseMatrix<double> CotangentLaplacian(const SolveMesh& mesh) {
  Vector<Eigen::Triplet<double>> entries;
  const auto add = [&entries](int i, int j, double weight) {
    entries.emplace_back(i, j, -weight);
    entries.emplace_back(j, i, -weight);
    entries.emplace_back(i, i, weight);
    entries.emplace_back(j, j, weight);
  };
  for (const WeightedEdge& edge : CotangentEdges(mesh))
    add(edge.i, edge.j, edge.weight);
  for (const Bridge& bridge : mesh.bridges)
    add(bridge.a, bridge.b, bridge.weight);
  Eigen::SparseMatrix<double> laplacian(mesh.num_vertices(), mesh.num_vertices());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

Eigen::VectorXd VertexAreas(const SolveMesh& mesh) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.num_vertices());
  if (areas.size() == 0) return areas;
  const PointMatrix& points = mesh.shapes[0];
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = points.row(triangle[0]);
    const Eigen::Vector3d b = points.row(triangle[1]), c = points.row(triangle[2]);
    const double area = 0.5 * (b - a).cross(c - a).norm();
    for (const int v : triangle)
      areas(v) += area / 3;
  }
  const double mean = areas.mean();
  if (!(mean > 0) || !std::isfinite(mean)) return Eigen::VectorXd::Ones(areas.size());
  return areas.cwiseMax(kSmallestArea * mean);
}

}  // namespace limber::geometry
