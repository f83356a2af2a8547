#include "geometry/bridges.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/point_tree.h"
#include "geometry/union_find.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace limber::geometry {
namespace {

bool IsConnected(const SolveMesh& mesh) {
  UnionFind sets(mesh.num_vertices());
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.Unite(a, b);
    sets.Unite(a, c);
  }
  for (const Bridge& bridge : mesh.bridges)
    sets.Unite(bridge.a, bridge.b);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (sets.Find(v) != 0) return false;
  }
  return true;
}

// A body, an eye inside it, two small parts and a vertex without a triangle.
SolveMesh MakeParts() {
  SolveMesh mesh = test::MakeBlob(6, 4);
  SolveMesh body = test::MakeBlob(20, 18);
  body.shapes[0] *= 3;
  test::Append(body, {0, 0, 0}, &mesh);
  SolveMesh tooth = test::MakeBlob(3, 1);
  tooth.shapes[0] *= 0.1;
  test::Append(tooth, {0, 6, 0}, &mesh);
  test::Append(tooth, {0, 9, 0}, &mesh);
  SolveMesh loose;
  loose.shapes = {PointMatrix::Zero(1, 3)};
  test::Append(loose, {-8, 0, 0}, &mesh);
  return mesh;
}

TEST(ConnectComponents, OneComponent_NeedsNoBridge) {
  SolveMesh mesh = test::MakeBlob(8, 5);
  ConnectComponents(&mesh);
  EXPECT_EQ(mesh.num_components, 1);
  EXPECT_TRUE(mesh.bridges.empty());
  EXPECT_EQ(mesh.component, Vector<int>(static_cast<size_t>(mesh.num_vertices()), 0));
}

TEST(ConnectComponents, Parts_AreNumberedBySizeAndAllConnected) {
  SolveMesh mesh = MakeParts();
  ConnectComponents(&mesh);
  ASSERT_EQ(mesh.num_components, 5);
  Vector<int> size(5, 0);
  for (const int component : mesh.component)
    ++size[component];
  EXPECT_EQ(size, (Vector<int>{362, 26, 5, 5, 1}));
  EXPECT_TRUE(IsConnected(mesh));
  for (const Bridge& bridge : mesh.bridges) {
    EXPECT_NE(mesh.component[bridge.a], mesh.component[bridge.b]);
    EXPECT_TRUE(std::isfinite(bridge.weight));
    EXPECT_GT(bridge.weight, 0);
  }
}

TEST(ConnectComponents, Part_IsHeldAtSeveralSpreadPoints) {
  SolveMesh mesh = MakeParts();
  ConnectComponents(&mesh);
  Vector<PointMatrix> ends(5, PointMatrix(0, 3));
  Vector<std::set<int>> starts(5);
  for (const Bridge& bridge : mesh.bridges) {
    // Each begins at the part that it ties, at a vertex of its own.
    EXPECT_TRUE(starts[mesh.component[bridge.a]].insert(bridge.a).second);
    PointMatrix& points = ends[mesh.component[bridge.a]];
    points.conservativeResize(points.rows() + 1, 3);
    points.row(points.rows() - 1) = mesh.shapes[0].row(bridge.a);
  }
  EXPECT_GE(ends[1].rows(), 6);
  EXPECT_LE(ends[1].rows(), 12);
  EXPECT_EQ(ends[4].rows(), 1);
  // The eye's ends span all three directions, so that nothing is left to turn freely.
  const PointMatrix centred = ends[1].rowwise() - ends[1].colwise().mean();
  const Eigen::Matrix3d spread = centred.transpose() * centred / double(centred.rows());
  EXPECT_GT(spread.determinant(), 1e-3);
}

TEST(ConnectComponents, DistantChain_HangsOnItsNeighbour) {
  // The outer part is nearer to the inner one than to the body.
  SolveMesh mesh = test::MakeBlob(16, 12);
  const SolveMesh small = test::MakeBlob(5, 3);
  test::Append(small, {10, 0, 0}, &mesh);
  test::Append(small, {5, 0, 0}, &mesh);
  ConnectComponents(&mesh);
  const int outer = mesh.component[mesh.num_vertices() - small.num_vertices() - 1];
  ASSERT_EQ(outer, 1);
  for (const Bridge& bridge : mesh.bridges) {
    if (mesh.component[bridge.a] == outer) {
      EXPECT_EQ(mesh.component[bridge.b], 2);
    }
  }
}

TEST(ConnectComponents, ManyParts_AreConnected) {
  SolveMesh mesh;
  mesh.shapes = {PointMatrix(5000, 3)};  // dust beyond the parts that are grown one by one
  for (int v = 0; v < 5000; ++v) {
    mesh.shapes[0].row(v) << std::cos(v * 2.4) * std::sqrt(v), std::sin(v * 2.4) * std::sqrt(v), 0;
  }
  mesh.triangles = {{0, 1, 2}};
  ConnectComponents(&mesh);
  EXPECT_EQ(mesh.num_components, 4998);
  EXPECT_TRUE(IsConnected(mesh));
}

TEST(ConnectComponents, CoincidentParts_AreConnected) {
  SolveMesh mesh;
  mesh.shapes = {PointMatrix::Zero(9, 3)};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  ConnectComponents(&mesh);
  EXPECT_EQ(mesh.num_components, 3);
  EXPECT_TRUE(IsConnected(mesh));
}

TEST(PointTree, FindNearest_AgreesWithALook) {
  const SolveMesh blob = test::MakeBlob(30, 20);
  const PointMatrix& points = blob.shapes[0];
  const PointTree tree(points, AllIndices(blob.num_vertices()));
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d x(std::sin(1.7 * i) * 2, std::cos(2.3 * i), std::sin(0.3 * i) * 3);
    double squared_distance = 1e300;
    int nearest = -1;
    tree.FindNearest(x, &squared_distance, &nearest);
    int expected = 0;
    const double smallest =
        (points.rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff(&expected);
    EXPECT_EQ(nearest, expected);
    EXPECT_DOUBLE_EQ(squared_distance, smallest);
  }
}

}  // namespace
}  // namespace limber::geometry
