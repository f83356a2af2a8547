#include "geometry/cotangent.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/bridges.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>

namespace limber::geometry {
namespace {

SolveMesh OneTriangle(const Eigen::Matrix3d& corners) {
  SolveMesh mesh;
  mesh.shapes = {corners};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(CornerCotangents, KnownAngles) {
  Eigen::Matrix3d corners;
  corners << 0, 0, 0, 1, 0, 0, 0, std::sqrt(3.0), 0;  // 90, 60 and 30 degrees
  const auto cotangents = CornerCotangents(OneTriangle(corners));
  EXPECT_NEAR(cotangents[0][0], 0, 1e-14);
  EXPECT_NEAR(cotangents[0][1], 1 / std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(cotangents[0][2], std::sqrt(3.0), 1e-14);
  // The unit of length does not matter, however extreme.
  for (const double scale : {1e-160, 1e-6, 1e6, 1e160}) {
    EXPECT_NEAR(CornerCotangents(OneTriangle(scale * corners))[0][2], std::sqrt(3.0), 1e-12);
  }
}

TEST(CotangentLaplacian, IsSymmetricPositiveSemidefiniteWithZeroRows) {
  SolveMesh mesh = test::MakeBlob(9, 7);
  test::Append(test::MakeBlob(4, 2), {5, 0, 0}, &mesh);
  ConnectComponents(&mesh);
  const Eigen::MatrixXd laplacian = CotangentLaplacian(mesh);
  EXPECT_EQ(laplacian, laplacian.transpose());
  EXPECT_LT(laplacian.rowwise().sum().lpNorm<Eigen::Infinity>(), 1e-12);
  for (int i = 0; i < laplacian.rows(); ++i) {
    for (int j = 0; j < i; ++j)
      EXPECT_LE(laplacian(i, j), 0);
  }
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(laplacian).eigenvalues();
  EXPECT_NEAR(eigenvalues(0), 0, 1e-11);
  EXPECT_GT(eigenvalues(1), 1e-4);  // connected: only the constants are free
}

TEST(CotangentLaplacian, RegularGrid_ReproducesLinearFunctions) {
  // Diagonals of right-angled squares weigh nothing, up to the clamp, which is linear as well here
  // because diagonals come in opposite pairs around an inner vertex.
  const SolveMesh mesh = test::MakeGrid(6, 5);
  const Eigen::SparseMatrix<double> laplacian = CotangentLaplacian(mesh);
  const Eigen::VectorXd linear = mesh.shapes[0] * Eigen::Vector3d(2, -3, 0);
  const Eigen::VectorXd result = laplacian * linear;
  for (int y = 1; y < 5; ++y) {
    for (int x = 1; x < 6; ++x)
      EXPECT_NEAR(result(y * 7 + x), 0, 1e-12);
  }
}

TEST(CotangentLaplacian, EnergyOfALinearFunction_IsItsGradientSquaredTimesArea) {
  // On a mesh of acute triangles, where nothing is clamped: a sheared grid of equilateral ones.
  SolveMesh mesh = test::MakeGrid(4, 3);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    const double x = mesh.shapes[0](v, 0), y = mesh.shapes[0](v, 1);
    mesh.shapes[0].row(v) << x - 0.5 * y, std::sqrt(0.75) * y, 0;
  }
  const Eigen::Vector3d gradient(1.5, -0.7, 0);
  const Eigen::VectorXd linear = mesh.shapes[0] * gradient;
  const double area = 4 * 3 * std::sqrt(0.75);
  EXPECT_NEAR(linear.dot(CotangentLaplacian(mesh) * linear), gradient.squaredNorm() * area, 1e-11);
  EXPECT_NEAR(VertexAreas(mesh).sum(), area, 1e-12);
}

TEST(Cotangent, DegenerateTriangles_StayFinite) {
  SolveMesh mesh = test::MakeGrid(3, 3);
  mesh.triangles.push_back({0, 1, 2});            // collinear
  mesh.triangles.push_back({0, 5, 15});           // collinear, on a diagonal
  mesh.shapes[0].row(6) = mesh.shapes[0].row(5);  // an edge of no length
  test::Append(test::MakeGrid(1, 1), {9, 9, 9}, &mesh);
  for (int v = 16; v < 20; ++v)
    mesh.shapes[0].row(v) << 9, 9, 9;  // a patch of no size
  for (const double scale : {1e-6, 1.0, 1e6}) {
    SolveMesh scaled = mesh;
    scaled.shapes[0] *= scale;
    ConnectComponents(&scaled);
    for (const auto& corners : CornerCotangents(scaled)) {
      for (const double cotangent : corners)
        EXPECT_LE(std::abs(cotangent), 100);
    }
    const Eigen::VectorXd areas = VertexAreas(scaled);
    EXPECT_TRUE(areas.allFinite());
    EXPECT_GT(areas.minCoeff(), 0);
    const Eigen::MatrixXd laplacian = CotangentLaplacian(scaled);
    ASSERT_TRUE(laplacian.allFinite());
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(laplacian).eigenvalues();
    EXPECT_NEAR(eigenvalues(0), 0, 1e-9);
    EXPECT_GT(eigenvalues(1), 1e-6);
  }
}

TEST(CotangentEdges, WeightsAreClampedAndEdgesSorted) {
  const SolveMesh mesh = test::MakeGrid(5, 5);
  const Vector<WeightedEdge> edges = CotangentEdges(mesh);
  EXPECT_EQ(edges.size(), 2U * 30 + 25);
  for (size_t e = 0; e < edges.size(); ++e) {
    EXPECT_LT(edges[e].i, edges[e].j);
    EXPECT_GT(edges[e].weight, 0);
    if (e > 0) {
      EXPECT_LT(std::pair(edges[e - 1].i, edges[e - 1].j), std::pair(edges[e].i, edges[e].j));
    }
  }
}

}  // namespace
}  // namespace limber::geometry
