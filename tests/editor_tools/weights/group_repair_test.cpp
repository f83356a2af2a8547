// Edge groups end up in one piece each.
#include "bake/group_repair.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"
#include "geometry/union_find.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using geometry::SolveMesh;

// Pieces that each group falls into.
std::map<int, int> NumPieces(const SolveMesh& mesh, const Vector<int>& group) {
  geometry::UnionFind sets(mesh.num_vertices());
  const auto unite = [&](int a, int b) {
    if (group[size_t(a)] == group[size_t(b)]) sets.Unite(a, b);
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    unite(a, b);
    unite(b, c);
    unite(c, a);
  }
  for (const geometry::Bridge& bridge : mesh.bridges)
    unite(bridge.a, bridge.b);
  std::map<int, int> pieces;
  for (int v = 0; v < mesh.num_vertices(); ++v)
    pieces[group[size_t(v)]] += sets.Find(v) == v;
  return pieces;
}

MatrixXd RandomRows(int rows, int columns, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(0, 1);
  MatrixXd weights(rows, columns);
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    weights.data()[i] = number(random);
  return weights;
}

TEST(ConnectGroups, RandomGroups_EndInOnePieceEach) {
  SolveMesh mesh = test::MakeGrid(20, 15);
  test::Append(test::MakeGrid(4, 4), {25, 2, 1}, &mesh);
  geometry::ConnectComponents(&mesh);
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    Vector<int> group(size_t(mesh.num_vertices()));
    for (int& g : group)
      g = int(random() % 7);
    const Vector<int> before = group;
    const int moved = ConnectGroups(mesh, RandomRows(mesh.num_vertices(), 3, seed), 7, &group);
    int different = 0;
    for (size_t v = 0; v < group.size(); ++v)
      different += group[v] != before[v];
    // A piece may come back to its own group by way of a neighbour.
    EXPECT_LE(different, moved);
    EXPECT_GT(different, 0);
    const auto pieces = NumPieces(mesh, group);
    EXPECT_EQ(pieces.size(), 7u) << "a group was lost";
    for (const auto& [g, count] : pieces)
      EXPECT_EQ(count, 1) << "group " << g << ", seed " << seed;
  }
}

TEST(ConnectGroups, ConnectedGroups_StayAsTheyAre) {
  const SolveMesh mesh = test::MakeGrid(12, 4);
  Vector<int> group(size_t(mesh.num_vertices()));
  for (size_t v = 0; v < group.size(); ++v)
    group[v] = int(mesh.shapes[0](Eigen::Index(v), 0)) / 5;
  const Vector<int> before = group;
  EXPECT_EQ(ConnectGroups(mesh, RandomRows(mesh.num_vertices(), 2, 1), 3, &group), 0);
  EXPECT_EQ(group, before);
}

// A crumb between two groups joins the one whose weights are like its own.
TEST(ConnectGroups, ACrumb_JoinsTheLikerNeighbour) {
  const SolveMesh mesh = test::MakeGrid(11, 2);
  MatrixXd weights(mesh.num_vertices(), 2);
  Vector<int> group(size_t(mesh.num_vertices()));
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const double x = mesh.shapes[0](v, 0);
    group[size_t(v)] = x < 6 ? 0 : x < 9 ? 1 : 2;
    weights.row(v) << (x < 6 ? 1 : x < 9 ? 0.5 : 0), 0;
    weights(v, 1) = 1 - weights(v, 0);
  }
  for (const double like : {0.9, 0.1}) {
    Vector<int> crumbed = group;
    MatrixXd own = weights;
    for (Eigen::Index v = 0; v < weights.rows(); ++v) {
      if (mesh.shapes[0](v, 0) != 6) continue;
      crumbed[size_t(v)] = 2;  // between groups 0 and 1, far from its own
      own.row(v) << like, 1 - like;
    }
    EXPECT_EQ(ConnectGroups(mesh, own, 3, &crumbed), 3);
    for (Eigen::Index v = 0; v < weights.rows(); ++v) {
      if (mesh.shapes[0](v, 0) == 6) {
        EXPECT_EQ(crumbed[size_t(v)], like > 0.75 ? 0 : 1);
      }
    }
  }
}

}  // namespace
}  // namespace limber::bake
