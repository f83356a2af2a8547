#include "bake/edge_groups.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"
#include "geometry/cotangent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using geometry::GroupEdge;
using geometry::SolveMesh;

// Rows around `centres` corners of the weight simplex, `each` of them.
MatrixXd ClusteredRows(int centres, int each) {
  MatrixXd rows(centres * each, centres);
  for (int i = 0; i < rows.rows(); ++i) {
    const double blur = 0.1 * (1 + std::sin(1.3 * i));
    rows.row(i).setConstant(blur / centres);
    rows(i, i % centres) += 1 - blur;
  }
  return rows;
}

std::set<std::set<int>> Partition(const Vector<int>& group, const Vector<int>& name) {
  std::map<int, std::set<int>> sets;
  for (size_t v = 0; v < group.size(); ++v)
    sets[group[v]].insert(name[v]);
  std::set<std::set<int>> partition;
  for (const auto& [number, set] : sets)
    partition.insert(set);
  return partition;
}

TEST(ClusterVertices, PlantedClusters_AreFound) {
  int num_groups = 0;
  const Vector<int> group = ClusterVertices(ClusteredRows(5, 20), 5, &num_groups);
  EXPECT_EQ(num_groups, 5);
  for (size_t v = 0; v < group.size(); ++v)
    EXPECT_EQ(group[v], group[v % 5]);
  EXPECT_EQ(std::set<int>(group.begin(), group.end()), (std::set<int>{0, 1, 2, 3, 4}));
}

TEST(ClusterVertices, RowOrder_ChangesOnlyTheNumbers) {
  const MatrixXd rows = ClusteredRows(4, 30);
  const Vector<int> order = test::Shuffle(120, 9);
  MatrixXd shuffled(rows.rows(), rows.cols());
  for (int v = 0; v < 120; ++v)
    shuffled.row(order[v]) = rows.row(v);
  Vector<int> names(120), names_shuffled(120);
  for (int v = 0; v < 120; ++v)
    names_shuffled[order[v]] = names[v] = v;
  int num_groups = 0;
  const auto reference = Partition(ClusterVertices(rows, 4, &num_groups), names);
  EXPECT_EQ(Partition(ClusterVertices(shuffled, 4, &num_groups), names_shuffled), reference);
}

TEST(ClusterVertices, FewerDistinctRowsThanWanted_GivesFewerGroups) {
  MatrixXd rows = MatrixXd::Zero(9, 3);
  for (int v = 0; v < 9; ++v)
    rows(v, v % 3) = 1;
  int num_groups = 0;
  const Vector<int> group = ClusterVertices(rows, 6, &num_groups);
  EXPECT_EQ(num_groups, 3);
  EXPECT_EQ(group, (Vector<int>{0, 1, 2, 0, 1, 2, 0, 1, 2}));
  ClusterVertices(MatrixXd::Ones(5, 1), 2, &num_groups);
  EXPECT_EQ(num_groups, 1);
}

TEST(ClusterVertices, EveryRow_IsNearestToItsOwnMean) {
  MatrixXd rows(400, 4);
  for (int v = 0; v < 400; ++v) {
    for (int h = 0; h < 4; ++h)
      rows(v, h) = 1 + std::sin(0.37 * v * (h + 1) + h);
    rows.row(v) /= rows.row(v).sum();
  }
  int num_groups = 0;
  const Vector<int> group = ClusterVertices(rows, 8, &num_groups);
  MatrixXd means = MatrixXd::Zero(num_groups, 4);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(num_groups);
  for (int v = 0; v < 400; ++v) {
    means.row(group[v]) += rows.row(v);
    counts(group[v]) += 1;
  }
  means = counts.cwiseInverse().asDiagonal() * means;
  for (int v = 0; v < 400; ++v) {
    const Eigen::VectorXd distance = (means.rowwise() - rows.row(v)).rowwise().norm();
    EXPECT_LE(distance(group[v]), distance.minCoeff() + 1e-12);
  }
}

TEST(BuildGroupEdges, WeightsOfAnEdge_SumToItsCotangentWeight) {
  SolveMesh mesh = test::MakeGrid(9, 7);
  for (int v = 0; v < mesh.num_vertices(); ++v) {  // equilateral: every part is positive
    const double x = mesh.shapes[0](v, 0), y = mesh.shapes[0](v, 1);
    mesh.shapes[0].row(v) << x - 0.5 * y, std::sqrt(0.75) * y, 0;
  }
  test::Append(test::MakeGrid(1, 1), {4, 2, 1}, &mesh);
  geometry::ConnectComponents(&mesh);
  Vector<int> group(static_cast<size_t>(mesh.num_vertices()));
  for (size_t v = 0; v < group.size(); ++v)
    group[v] = static_cast<int>(v * v / 7 % 4);

  std::map<std::pair<int, int>, double> expected, found;
  for (const geometry::WeightedEdge& edge : geometry::CotangentEdges(mesh)) {
    expected[{edge.i, edge.j}] += edge.weight;
  }
  for (const geometry::Bridge& bridge : mesh.bridges) {
    expected[std::minmax(bridge.a, bridge.b)] += bridge.weight;
  }
  for (const GroupEdge& edge : BuildGroupEdges(mesh, group)) {
    found[{edge.i, edge.j}] += edge.weight;
  }
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [edge, weight] : expected) {
    // The square that was put beside has right angles: its diagonal is clamped, once a group.
    const bool clamped = edge.first >= 80;
    EXPECT_NEAR(found[edge], weight, clamped ? 5e-3 : 1e-12) << edge.first << " " << edge.second;
  }
}

TEST(BuildGroupEdges, SpokesAndRims_OneTriangle) {
  SolveMesh mesh;
  mesh.shapes = {geometry::PointMatrix(3, 3)};
  mesh.shapes[0] << 0, 0, 0, 1, 0, 0, 0.5, std::sqrt(0.75), 0;
  mesh.triangles = {{0, 1, 2}};
  const Vector<GroupEdge> edges = BuildGroupEdges(mesh, {0, 0, 1});
  ASSERT_EQ(edges.size(), 6U);
  const double whole = 0.5 / std::sqrt(3.0);
  for (size_t e = 0; e < 6; ++e) {
    EXPECT_EQ(edges[e].group, e < 3 ? 0 : 1);
    EXPECT_NEAR(edges[e].weight, e < 3 ? 2 * whole / 3 : whole / 3, 1e-14);
  }
}

TEST(BuildGroupEdges, AreSortedPositiveAndDistinct) {
  SolveMesh mesh = test::MakeBlob(14, 10);
  mesh.shapes[0].row(30) = mesh.shapes[0].row(31);  // degenerate triangles among them
  Vector<int> group(static_cast<size_t>(mesh.num_vertices()));
  for (size_t v = 0; v < group.size(); ++v)
    group[v] = static_cast<int>(v / 29);
  const Vector<GroupEdge> edges = BuildGroupEdges(mesh, group);
  for (size_t e = 0; e < edges.size(); ++e) {
    EXPECT_LT(edges[e].i, edges[e].j);
    EXPECT_GT(edges[e].weight, 0);
    EXPECT_TRUE(std::isfinite(edges[e].weight));
    if (e > 0) {
      EXPECT_LT(std::tie(edges[e - 1].group, edges[e - 1].i, edges[e - 1].j),
                std::tie(edges[e].group, edges[e].i, edges[e].j));
    }
  }
}

}  // namespace
}  // namespace limber::bake
