#include "bake/group_tensors.h"

#include "core/vector.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace limber::bake {
namespace {

using geometry::GroupEdge;

void AddEdge(int i, int j, double weight, Vector<Eigen::Triplet<double>>* triplets) {
  triplets->emplace_back(i, i, weight);
  triplets->emplace_back(j, j, weight);
  triplets->emplace_back(i, j, -weight);
  triplets->emplace_back(j, i, -weight);
}

Vector<int> VerticesOf(std::span<const GroupEdge> edges) {
  Vector<int> vertices;
  vertices.reserve(2 * edges.size());
  for (const GroupEdge& edge : edges) {
    vertices.push_back(edge.i);
    vertices.push_back(edge.j);
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

GroupTensors BuildOne(const Vector<Eigen::MatrixXd>& shapes, std::span<const GroupEdge> edges) {
  const auto num_shapes = static_cast<Eigen::Index>(shapes.size());
  const Eigen::Index k = shapes.front().cols();
  GroupTensors group;
  group.vertices = VerticesOf(edges);
  const auto num_vertices = static_cast<Eigen::Index>(group.vertices.size());
  group.edge_load = Eigen::MatrixXd::Zero(num_vertices, num_shapes * k);
  const auto num_edges = static_cast<Eigen::Index>(edges.size());
  Eigen::MatrixXd weighted_edges(num_edges, num_shapes * k);  // sqrt(C_g) E_g
  Vector<Eigen::Triplet<double>> triplets;
  const auto local = [&group](int vertex) {
    const auto at = std::lower_bound(group.vertices.begin(), group.vertices.end(), vertex);
    return static_cast<int>(at - group.vertices.begin());
  };
  for (Eigen::Index e = 0; e < num_edges; ++e) {
    const GroupEdge& edge = edges[static_cast<size_t>(e)];
    const int i = local(edge.i), j = local(edge.j);
    AddEdge(i, j, edge.weight, &triplets);
    for (Eigen::Index s = 0; s < num_shapes; ++s) {
      const Eigen::MatrixXd& shape = shapes[static_cast<size_t>(s)];
      const auto vector = shape.row(edge.j) - shape.row(edge.i);
      group.edge_load.row(j).segment(s * k, k) += edge.weight * vector;
      group.edge_load.row(i).segment(s * k, k) -= edge.weight * vector;
      weighted_edges.row(e).segment(s * k, k) = std::sqrt(edge.weight) * vector;
    }
  }
  group.shape_gram = weighted_edges.transpose() * weighted_edges;
  group.laplacian.resize(num_vertices, num_vertices);
  group.laplacian.setFromTriplets(triplets.begin(), triplets.end());
  return group;
}

}  // namespace

Eigen::MatrixXd GroupTensors::Rows(const Eigen::MatrixXd& matrix) const {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(vertices.size()), matrix.cols());
  for (size_t v = 0; v < vertices.size(); ++v) {
    rows.row(static_cast<Eigen::Index>(v)) = matrix.row(vertices[v]);
  }
  return rows;
}

Vector<GroupTensors> BuildGroupTensors(const Vector<Eigen::MatrixXd>& shapes,
                                       const Vector<GroupEdge>& edges, int num_groups) {
  Vector<GroupTensors> groups;
  groups.reserve(static_cast<size_t>(num_groups));
  size_t first = 0;
  for (int g = 0; g < num_groups; ++g) {
    size_t last = first;
    while (last < edges.size() && edges[last].group == g)
      ++last;
    groups.push_back(BuildOne(shapes, std::span(edges).subspan(first, last - first)));
    first = last;
  }
  return groups;
}

Eigen::SparseMatrix<double> SumLaplacian(const Vector<GroupEdge>& edges, int num_vertices) {
  Vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(4 * edges.size());
  for (const GroupEdge& edge : edges)
    AddEdge(edge.i, edge.j, edge.weight, &triplets);
  Eigen::SparseMatrix<double> laplacian(num_vertices, num_vertices);
  laplacian.setFromTriplets(triplets.begin(), triplets.end());
  return laplacian;
}

}  // namespace limber::bake
