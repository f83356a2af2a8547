#include "geometry/geodesic.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"
#include "geometry/extremities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace limber::geometry {
namespace {

// A blob drawn out into `arms` long arms in the xz plane.
SolveMesh MakeStar(int arms) {
  SolveMesh mesh = test::MakeBlob(24 * arms, 40);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    Eigen::RowVector3d p = mesh.shapes[0].row(v).normalized();
    const double angle = std::atan2(p.z(), p.x());
    const double lobe = std::pow(0.5 + 0.5 * std::cos(arms * angle), 6);
    p.x() *= 1 + 5 * lobe;
    p.z() *= 1 + 5 * lobe;
    mesh.shapes[0].row(v) = p;
  }
  return mesh;
}

TEST(EdgeGraph, Distances_AreShortestPaths) {
  const SolveMesh mesh = test::MakeGrid(7, 5);
  const Eigen::VectorXd distance = EdgeGraph(mesh).Distances(std::array{0});
  for (int y = 0; y <= 5; ++y) {
    for (int x = 0; x <= 7; ++x) {  // the squares' diagonals lead from (0, 0) towards (1, 1)
      const double expected = std::sqrt(2.0) * std::min(x, y) + std::abs(x - y);
      EXPECT_NEAR(distance(y * 8 + x), expected, 1e-12);
    }
  }
}

TEST(EdgeGraph, Bridges_LeadToOtherParts) {
  SolveMesh mesh = test::MakeGrid(1, 1);
  test::Append(test::MakeGrid(1, 1), {3, 0, 0}, &mesh);
  EXPECT_EQ(EdgeGraph(mesh).Distances(std::array{0})(4), std::numeric_limits<double>::infinity());
  mesh.bridges = {{4, 1, 1.0}};
  EXPECT_NEAR(EdgeGraph(mesh).Distances(std::array{0})(4), 3, 1e-12);
}

TEST(SpreadPoints, Star_EveryArmComesFirst) {
  const int arms = 5;
  SolveMesh mesh = MakeStar(arms);
  ConnectComponents(&mesh);
  std::set<int> arms_found;
  for (const int v : SpreadPoints(mesh, arms)) {
    const Eigen::RowVector3d p = mesh.shapes[0].row(v);
    EXPECT_GT(std::hypot(p.x(), p.z()), 5.5);  // at the arm's end: arms reach to 6
    const double turn = std::atan2(p.z(), p.x()) / (2 * std::numbers::pi) * arms;
    arms_found.insert((static_cast<int>(std::lround(turn)) + arms) % arms);
  }
  EXPECT_EQ(arms_found.size(), static_cast<size_t>(arms));
}

TEST(SpreadPoints, AreDistinctDeterministicAndGrowByAppending) {
  SolveMesh mesh = MakeStar(3);
  ConnectComponents(&mesh);
  const Vector<int> many = SpreadPoints(mesh, 20);
  EXPECT_EQ(std::set<int>(many.begin(), many.end()).size(), 20U);
  EXPECT_EQ(SpreadPoints(mesh, 20), many);
  EXPECT_EQ(SpreadPoints(mesh, 7), Vector<int>(many.begin(), many.begin() + 7));
}

TEST(SpreadPoints, SmallParts_AreLeftOut) {
  SolveMesh mesh = test::MakeBlob(24, 20);
  SolveMesh tooth = test::MakeBlob(3, 1);
  tooth.shapes[0] *= 0.1;
  test::Append(tooth, {4, 0, 0}, &mesh);
  ConnectComponents(&mesh);
  for (const int v : SpreadPoints(mesh, 30))
    EXPECT_EQ(mesh.component[v], 0);
}

// The tinier the mesh, the larger a share of it one loose vertex is.
TEST(SpreadPoints, VerticesWithoutTriangles_AreNeverChosen) {
  SolveMesh loose;
  loose.shapes.push_back(geometry::PointMatrix::Zero(1, 3));
  SolveMesh mesh = test::MakeGrid(2, 1);
  const int num_used = mesh.num_vertices();
  test::Append(loose, {9, 0, 0}, &mesh);
  test::Append(loose, {-9, 0, 0}, &mesh);
  ConnectComponents(&mesh);
  ASSERT_EQ(mesh.num_vertices(), num_used + 2);
  const Vector<int> points = SpreadPoints(mesh, 10);
  EXPECT_EQ(points.size(), static_cast<size_t>(num_used));
  for (const int v : points)
    EXPECT_LT(v, num_used);
  ConnectComponents(&loose);
  EXPECT_TRUE(SpreadPoints(loose, 3).empty());
}

TEST(SpreadPoints, FewerPointsThanWanted_GivesThemAll) {
  SolveMesh mesh = test::MakeGrid(1, 1);
  ConnectComponents(&mesh);
  EXPECT_EQ(SpreadPoints(mesh, 10).size(), 4U);
  EXPECT_TRUE(SpreadPoints(mesh, 0).empty());
  EXPECT_TRUE(SpreadPoints(SolveMesh(), 3).empty());
}

}  // namespace
}  // namespace limber::geometry
