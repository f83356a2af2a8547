#include "geometry/robust_laplacian.h"

#include "core/vector.h"
#include "geometry/cotangent.h"
#include "geometry/intrinsic_delaunay.h"
#include "geometry/tufted_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace limber::geometry {
namespace {

constexpr double kSmallestArea = 1e-4;                         // of the mean vertex area
constexpr int64_t kFlipsPerEdge = 64, kFlipsAtLeast = 100000;  // that are enough

Vector<std::array<int, 3>> UsableTriangles(const SolveMesh& mesh) {
  Vector<std::array<int, 3>> usable;
  usable.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = triangle;
    if (a == b || b == c || c == a) continue;
    const auto is_finite = [&mesh](int v) { return mesh.shapes[0].row(v).allFinite(); };
    if (is_finite(a) && is_finite(b) && is_finite(c)) usable.push_back(triangle);
  }
  return usable;
}

// The edges of the cover that join different vertices, each with its share of the Laplacian; adds
// their part of the Voronoi cells to `areas`.
Vector<WeightedEdge> EdgesOfCover(const IntrinsicTriangulation& cover, double unit,
                                  Eigen::VectorXd* areas) {
  Vector<WeightedEdge> edges;
  edges.reserve(cover.tail.size() / 2);
  for (int h = 0; h < cover.num_halfedges(); ++h) {
    const int g = cover.twin[h];
    if (g < h) continue;
    const double weight = std::max(CotangentWeight(cover, h), 0.0);
    const double length = cover.length[h] * unit;
    const int i = cover.tail[h], j = cover.tail[g];
    for (const int v : {i, j})
      (*areas)(v) += 0.125 * weight * length * length;
    if (i == j || weight == 0) continue;
    edges.push_back({i, j, 0.5 * std::min(weight, kLargestWeight)});
  }
  return edges;
}

// Raises the weights at each vertex that is held by less than kSmallestHold.
void HoldTips(int num_vertices, Vector<WeightedEdge>* edges) {
  Eigen::VectorXd hold = Eigen::VectorXd::Zero(num_vertices);
  for (const WeightedEdge& edge : *edges) {
    hold(edge.i) += edge.weight;
    hold(edge.j) += edge.weight;
  }
  for (WeightedEdge& edge : *edges) {
    const double least = std::min(hold(edge.i), hold(edge.j));
    if (least < kSmallestHold) edge.weight *= kSmallestHold / least;
  }
}

Eigen::SparseMatrix<double> Assemble(int num_vertices, const Vector<WeightedEdge>& edges) {
  Vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * edges.size() + static_cast<size_t>(num_vertices));
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(num_vertices);
  for (const auto& [i, j, weight] : edges) {
    entries.emplace_back(i, j, -weight);
    entries.emplace_back(j, i, -weight);
    diagonal(i) += weight;
    diagonal(j) += weight;
  }
  for (int v = 0; v < num_vertices; ++v)
    entries.emplace_back(v, v, diagonal(v));
  Eigen::SparseMatrix<double> laplacian(num_vertices, num_vertices);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

Eigen::VectorXd PositiveAreas(const Eigen::VectorXd& areas) {
  if (areas.size() == 0) return areas;
  const double mean = areas.mean();
  if (!(mean > 0) || !std::isfinite(mean)) return Eigen::VectorXd::Ones(areas.size());
  return areas.cwiseMax(kSmallestArea * mean);
}

}  // namespace

RobustLaplacian MakeRobustLaplacian(const SolveMesh& mesh, int64_t max_flips) {
  RobustLaplacian result;
  const Vector<std::array<int, 3>> triangles = UsableTriangles(mesh);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.num_vertices());
  Vector<WeightedEdge> edges;
  if (!triangles.empty()) {
    const SideLengths lengths = MollifiedLengths(mesh.shapes[0], triangles);
    IntrinsicTriangulation cover = TuftedCover(mesh.shapes[0], triangles, lengths);
    if (max_flips < 0) max_flips = kFlipsAtLeast + kFlipsPerEdge * (cover.num_halfedges() / 2);
    result.is_delaunay = FlipToDelaunay(max_flips, &cover);
    edges = EdgesOfCover(cover, lengths.unit, &areas);
    HoldTips(mesh.num_vertices(), &edges);
  }
  for (const Bridge& bridge : mesh.bridges)
    edges.push_back({bridge.a, bridge.b, bridge.weight});
  result.laplacian = Assemble(mesh.num_vertices(), edges);
  result.areas = PositiveAreas(areas);
  return result;
}

}  // namespace limber::geometry
