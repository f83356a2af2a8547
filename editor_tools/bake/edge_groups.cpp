#include "bake/edge_groups.h"

#include "core/vector.h"
#include "geometry/cotangent.h"
#include "threads/parallel_for.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace limber::bake {
namespace {

using geometry::GroupEdge;

constexpr int kMaxLloydIterations = 100;

// Farthest points in weight space; the first is the row farthest from the mean, and a tie goes to
// the first of the rows. Stops early when every row coincides with a centre.
Eigen::MatrixXd SeedCentres(const Eigen::MatrixXd& rows, int wanted) {
  Eigen::MatrixXd centres(wanted, rows.cols());
  const Eigen::RowVectorXd mean = rows.colwise().mean();
  Eigen::VectorXd spacing = (rows.rowwise() - mean).rowwise().squaredNorm();
  int count = 0;
  for (; count < wanted; ++count) {
    Eigen::Index farthest = 0;
    if (!(spacing.maxCoeff(&farthest) > 0) && count > 0) break;
    centres.row(count) = rows.row(farthest);
    const Eigen::VectorXd distance = (rows.rowwise() - centres.row(count)).rowwise().squaredNorm();
    spacing = count == 0 ? distance : Eigen::VectorXd(spacing.cwiseMin(distance));
  }
  return centres.topRows(count);
}

// Nearest centre of a point, the first of equals; centres are columns.
int FindNearest(const double* point, const Eigen::MatrixXd& centres) {
  double best = std::numeric_limits<double>::infinity();
  int nearest = 0;
  for (int c = 0; c < centres.cols(); ++c) {
    const double* centre = centres.col(c).data();
    double distance = 0;
    for (Eigen::Index i = 0; i < centres.rows() && distance < best; ++i)
      distance += (point[i] - centre[i]) * (point[i] - centre[i]);
    if (distance < best) {
      best = distance;
      nearest = c;
    }
  }
  return nearest;
}

// Puts each point, a column, to its nearest centre. Returns whether any changed its group.
bool Assign(const Eigen::MatrixXd& points, const Eigen::MatrixXd& centres, int num_threads,
            Vector<int>* group) {
  constexpr int kPointsAtOnce = 4096;
  const auto num_points = static_cast<int>(points.cols());
  std::atomic<bool> changed = false;
  threads::ParallelFor((num_points + kPointsAtOnce - 1) / kPointsAtOnce, num_threads,
                       [&](int chunk) {
                         const int first = chunk * kPointsAtOnce;
                         for (int v = first; v < std::min(first + kPointsAtOnce, num_points); ++v) {
                           int& of_point = (*group)[static_cast<size_t>(v)];
                           const int nearest = FindNearest(points.col(v).data(), centres);
                           if (nearest != of_point) changed = true;
                           of_point = nearest;
                         }
                       });
  return changed;
}

// Means of the groups; groups without a point keep their centre.
void MoveCentres(const Eigen::MatrixXd& points, const Vector<int>& group,
                 Eigen::MatrixXd* centres) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centres->rows(), centres->cols());
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(centres->cols());
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    sums.col(group[v]) += points.col(v);
    counts(group[v]) += 1;
  }
  for (Eigen::Index c = 0; c < centres->cols(); ++c) {
    if (counts(c) > 0) centres->col(c) = sums.col(c) / counts(c);
  }
}

// Renumbers the groups that are in use in the order of their first vertex; returns how many.
int CompactGroups(Vector<int>* group, int num_groups) {
  Vector<int> number(static_cast<size_t>(num_groups), -1);
  int used = 0;
  for (int& g : *group) {
    if (number[g] < 0) number[g] = used++;
    g = number[g];
  }
  return used;
}

bool Before(const GroupEdge& a, const GroupEdge& b) {
  return std::tie(a.group, a.i, a.j) < std::tie(b.group, b.i, b.j);
}

// Sums entries of one (group, edge) and clamps the sums to a small positive weight.
void MergeAndClamp(Vector<GroupEdge>* edges) {
  std::stable_sort(edges->begin(), edges->end(), Before);
  size_t count = 0;
  double sum = 0;
  for (const GroupEdge& edge : *edges) {
    sum += std::abs(edge.weight);
    if (count > 0 && !Before((*edges)[count - 1], edge)) {
      (*edges)[count - 1].weight += edge.weight;
    } else {
      (*edges)[count++] = edge;
    }
  }
  edges->resize(count);
  const double mean = count > 0 && sum > 0 ? sum / static_cast<double>(count) : 1;
  const double smallest = geometry::kSmallestEdgeWeight * mean;
  for (GroupEdge& edge : *edges)
    edge.weight = std::max(edge.weight, smallest);
}

}  // namespace

Vector<int> ClusterVertices(const Eigen::MatrixXd& weights, int wanted, int* num_groups,
                            int num_threads) {
  Vector<int> group(static_cast<size_t>(weights.rows()), 0);
  *num_groups = weights.rows() > 0 ? 1 : 0;
  if (weights.rows() == 0 || wanted <= 1) return group;
  wanted = static_cast<int>(std::min<Eigen::Index>(wanted, weights.rows()));
  const Eigen::MatrixXd points = weights.transpose();  // each in one piece
  Eigen::MatrixXd centres = SeedCentres(weights, wanted).transpose();
  for (int iteration = 0; iteration < kMaxLloydIterations; ++iteration) {
    const bool changed = Assign(points, centres, num_threads, &group);
    if (!changed && iteration > 0) break;
    MoveCentres(points, group, &centres);
  }
  *num_groups = CompactGroups(&group, static_cast<int>(centres.cols()));
  return group;
}

Vector<GroupEdge> BuildGroupEdges(const geometry::SolveMesh& mesh,
                                  const Vector<int>& vertex_group) {
  const auto cotangents = geometry::CornerCotangents(mesh);
  Vector<GroupEdge> edges;
  edges.reserve(9 * mesh.triangles.size() + 2 * mesh.bridges.size());
  const auto add = [&edges](int group, int a, int b, double weight) {
    edges.push_back({group, std::min(a, b), std::max(a, b), weight});
  };
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<int, 3>& triangle = mesh.triangles[t];
    for (int corner = 0; corner < 3; ++corner) {
      const double third = 0.5 * cotangents[t][corner] / 3;
      for (const int v : triangle) {
        add(vertex_group[v], triangle[(corner + 1) % 3], triangle[(corner + 2) % 3], third);
      }
    }
  }
  for (const geometry::Bridge& bridge : mesh.bridges) {
    add(vertex_group[bridge.a], bridge.a, bridge.b, 0.5 * bridge.weight);
    add(vertex_group[bridge.b], bridge.a, bridge.b, 0.5 * bridge.weight);
  }
  MergeAndClamp(&edges);
  return edges;
}

void ScaleEdges(const Eigen::VectorXd& vertex_stiffness, Vector<GroupEdge>* edges) {
  for (GroupEdge& edge : *edges)
    edge.weight *= std::sqrt(vertex_stiffness[edge.i] * vertex_stiffness[edge.j]);
}

}  // namespace limber::bake
