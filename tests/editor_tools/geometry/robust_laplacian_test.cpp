#include "geometry/robust_laplacian.h"

#include "core/vector.h"
#include "editor_tools/geometry/soup_meshes.h"
#include "geometry/bridges.h"
#include "geometry/cotangent.h"
#include "geometry/union_find.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace limber::geometry {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Dense(const SolveMesh& mesh) {
  return MakeRobustLaplacian(mesh).laplacian;
}

double LargestDifference(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).lpNorm<Eigen::Infinity>();
}

VectorXd Eigenvalues(const MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

// Every kind of damage in turn: soups, spoilt surfaces, spoilt soups.
SolveMesh BrokenMesh(uint32_t seed) {
  SolveMesh mesh = seed % 3 == 0   ? test::MakeBlob(5 + int(seed % 7), 3 + int(seed % 5))
                   : seed % 3 == 1 ? test::MakeSoup(6 + int(seed), 40, seed)
                                   : test::MakeBook(3 + int(seed % 4));
  test::Spoil(seed, &mesh);
  return mesh;
}

// Parts that hang together through triangles, loose vertices among them.
int NumParts(const SolveMesh& mesh) {
  UnionFind sets(mesh.num_vertices());
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.Unite(a, b);
    sets.Unite(a, c);
  }
  int count = 0;
  for (int v = 0; v < mesh.num_vertices(); ++v)
    count += sets.Find(v) == v ? 1 : 0;
  return count;
}

void ExpectSound(const RobustLaplacian& result) {
  EXPECT_TRUE(result.areas.allFinite());
  EXPECT_GT(result.areas.minCoeff(), 0);
  const MatrixXd laplacian = result.laplacian;
  ASSERT_TRUE(laplacian.allFinite());
  EXPECT_EQ(laplacian, laplacian.transpose());
  const MatrixXd off_diagonal = laplacian - MatrixXd(laplacian.diagonal().asDiagonal());
  EXPECT_LE(off_diagonal.maxCoeff(), 0);
  EXPECT_LE(laplacian.rowwise().sum().cwiseAbs().maxCoeff(), 1e-12 * laplacian.maxCoeff());
}

TEST(RobustLaplacian, DelaunaySurface_IsTheCotangentLaplacian) {
  const SolveMesh sphere = test::MakeIcosphere(3);
  const RobustLaplacian result = MakeRobustLaplacian(sphere);
  EXPECT_LT(LargestDifference(result.laplacian, CotangentLaplacian(sphere)), 1e-12);
  EXPECT_LT(LargestDifference(result.laplacian, test::SummedCotangents(sphere)), 1e-12);
  EXPECT_NEAR(result.areas.sum(), VertexAreas(sphere).sum(), 1e-12);
}

TEST(RobustLaplacian, Areas_AreThoseOfVoronoiCells) {
  // A hexagon of equilateral triangles around vertex 0, which gets a third of each; two of them
  // side by side split evenly at their own corners.
  SolveMesh mesh;
  PointMatrix points(7, 3);
  points.row(0).setZero();
  for (int i = 0; i < 6; ++i) {
    points.row(1 + i) << 2 * std::cos(i * std::acos(0.5)), 2 * std::sin(i * std::acos(0.5)), 0;
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % 6});
  }
  mesh.shapes = {points};
  VectorXd areas = MakeRobustLaplacian(mesh).areas;
  EXPECT_NEAR(areas(0), 2 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(areas.sum(), 6 * std::sqrt(3.0), 1e-12);
  // A rectangle, whichever way it is cut, gives each corner a quarter; barycentric areas do not.
  mesh = test::MakeGrid(1, 1);
  mesh.shapes[0].col(0) *= 3;
  areas = MakeRobustLaplacian(mesh).areas;
  EXPECT_LT((areas.array() - 0.75).abs().maxCoeff(), 1e-12);
}

TEST(RobustLaplacian, CocircularQuadrilaterals_EitherDiagonalWillDo) {
  SolveMesh grid = test::MakeGrid(9, 7);
  SolveMesh flipped = test::RandomlyFlipped(grid, 0, 0);
  for (size_t t = 0; t < flipped.triangles.size(); t += 4) {
    const auto [a, b, d] = flipped.triangles[t];
    const int c = flipped.triangles[t + 1][2];
    flipped.triangles[t] = {a, b, c};
    flipped.triangles[t + 1] = {b, d, c};
  }
  ASSERT_GT(LargestDifference(VertexAreas(grid), VertexAreas(flipped)), 0.1);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  grid.shapes[0] *= turn / 3;  // so that right angles are right to rounding only
  flipped.shapes[0] = grid.shapes[0];
  const RobustLaplacian one = MakeRobustLaplacian(grid), other = MakeRobustLaplacian(flipped);
  ExpectSound(one);  // zero weights are not negative, not even in rounding
  EXPECT_LT(LargestDifference(one.laplacian, other.laplacian), 1e-12);
  EXPECT_LT(LargestDifference(one.areas, other.areas), 1e-12);
}

TEST(RobustLaplacian, TriangulationOfAFlatPiece_DoesNotMatter) {
  const SolveMesh square = test::MakeJitteredSquare(9, 3);
  const SolveMesh flipped = test::RandomlyFlipped(square, 3000, 5);
  ASSERT_GT(LargestDifference(CotangentLaplacian(square), CotangentLaplacian(flipped)), 1);
  const RobustLaplacian one = MakeRobustLaplacian(square), other = MakeRobustLaplacian(flipped);
  EXPECT_LT(LargestDifference(one.laplacian, other.laplacian), 1e-10);
  EXPECT_LT(LargestDifference(one.areas, other.areas), 1e-12);
}

TEST(RobustLaplacian, Book_IsTheSumOverItsPages) {
  for (const int num_pages : {1, 2, 3, 4, 7}) {
    const SolveMesh book = test::MakeBook(num_pages);
    EXPECT_LT(LargestDifference(Dense(book), test::SummedCotangents(book)), 1e-12) << num_pages;
    EXPECT_NEAR(MakeRobustLaplacian(book).areas.sum(), num_pages * 3 * 1.6, 1e-12);
  }
}

TEST(RobustLaplacian, Flips_OnlyLowerTheEnergy) {
  for (uint32_t seed = 0; seed < 10; ++seed) {
    const SolveMesh soup = test::MakeSoup(15, 30, seed);
    const VectorXd spread = Eigenvalues(test::SummedCotangents(soup) - Dense(soup));
    EXPECT_GE(spread(0), -1e-3 * spread.tail<1>()(0)) << seed;  // lengthened by up to 1e-5
    EXPECT_GT(spread.tail<1>()(0), 0.1);
  }
}

TEST(RobustLaplacian, CopiesOfAllTriangles_AddAPillowAtEach) {
  // Between a triangle and its copy lies a closed surface of two faces. It weighs what the triangle
  // does by itself: its cotangents, where no angle is obtuse.
  const SolveMesh sphere = test::MakeIcosphere(1);
  SolveMesh twice = sphere;
  twice.triangles.insert(twice.triangles.end(), sphere.triangles.begin(), sphere.triangles.end());
  EXPECT_LT(LargestDifference(Dense(twice), 2 * Dense(sphere)), 1e-12);
  EXPECT_LT(
      LargestDifference(MakeRobustLaplacian(twice).areas, 2 * MakeRobustLaplacian(sphere).areas),
      1e-12);

  const SolveMesh blob = test::MakeBlob(8, 6);  // with obtuse angles
  MatrixXd expected = Dense(blob);
  for (const auto& triangle : blob.triangles) {
    SolveMesh alone = blob;
    alone.triangles = {triangle};
    expected += Dense(alone);
  }
  ASSERT_GT(LargestDifference(expected, 2 * Dense(blob)), 0.1);
  twice = blob;
  twice.triangles.insert(twice.triangles.end(), blob.triangles.begin(), blob.triangles.end());
  EXPECT_LT(LargestDifference(Dense(test::Rewound(twice, 4)), expected), 1e-11);
}

TEST(RobustLaplacian, BrokenMeshes_AreSound) {
  for (uint32_t seed = 0; seed < 60; ++seed) {
    const SolveMesh mesh = BrokenMesh(seed);
    const RobustLaplacian result = MakeRobustLaplacian(mesh);
    SCOPED_TRACE(seed);
    ExpectSound(result);
    EXPECT_TRUE(result.is_delaunay);
    const VectorXd eigenvalues = Eigenvalues(result.laplacian);
    const int num_parts = NumParts(mesh);
    EXPECT_GE(eigenvalues(0), -1e-12 * result.laplacian.diagonal().maxCoeff());
    // Constant on each part and nothing else, although a vertex may hang by a mollified needle
    // only, which holds it with about kMollification.
    EXPECT_LT(std::abs(eigenvalues(num_parts - 1)), 1e-12 * eigenvalues.tail<1>()(0));
    EXPECT_GT(eigenvalues(num_parts), 1e-4);
  }
}

TEST(RobustLaplacian, FlipsGivenUp_LeaveItSoundAndClamped) {
  // Without any flip negative weights of a closed surface are cut off, as CotangentLaplacian does.
  const SolveMesh blob = test::MakeBlob(12, 5);
  MatrixXd clamped = test::SummedCotangents(blob);
  clamped.diagonal().setZero();
  ASSERT_GT(clamped.maxCoeff(), 0.1);
  clamped = clamped.cwiseMin(0);
  clamped.diagonal() = -clamped.rowwise().sum();
  EXPECT_LT(LargestDifference(MakeRobustLaplacian(blob, 0).laplacian, clamped), 1e-12);
  for (uint32_t seed = 0; seed < 10; ++seed) {
    const RobustLaplacian result = MakeRobustLaplacian(BrokenMesh(seed), 5);
    EXPECT_FALSE(result.is_delaunay);
    ExpectSound(result);
  }
}

TEST(RobustLaplacian, BrokenMeshes_ObeyTheMaximumPrinciple) {
  for (uint32_t seed = 0; seed < 60; ++seed) {
    SolveMesh mesh = BrokenMesh(seed);
    ConnectComponents(&mesh);
    std::mt19937 random(seed);
    VectorXd values = VectorXd::Zero(mesh.num_vertices());
    Vector<bool> is_fixed(static_cast<size_t>(mesh.num_vertices()), false);
    for (int i = 0; i < 5; ++i) {
      const int v = static_cast<int>(random() % uint32_t(mesh.num_vertices()));
      is_fixed[v] = true;
      values(v) = i % 2;
    }
    const VectorXd zero = VectorXd::Zero(mesh.num_vertices());
    const VectorXd harmonic = test::SolveWithFixed(Dense(mesh), zero, is_fixed, values);
    EXPECT_GE(harmonic.minCoeff(), -1e-9) << seed;
    EXPECT_LE(harmonic.maxCoeff(), 1 + 1e-9) << seed;
  }
}

TEST(RobustLaplacian, Order_DoesNotMatter) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    SolveMesh mesh = seed % 2 == 0 ? test::MakeBlob(8, 6) : test::MakeSoup(14, 30, seed);
    mesh.triangles.push_back({0, 2, 11});  // a fin
    mesh.triangles.push_back({0, 2, 7});   // and another
    for (size_t t = 0; t < 9; ++t)
      mesh.triangles.push_back(mesh.triangles[3 * t]);
    const RobustLaplacian expected = MakeRobustLaplacian(mesh);
    const Vector<int> order = test::Shuffle(mesh.num_vertices(), seed);
    const SolveMesh shuffled = test::Rewound(test::Renumbered(mesh, order), seed);
    const RobustLaplacian result = MakeRobustLaplacian(shuffled);
    const Eigen::PermutationMatrix<Eigen::Dynamic> permutation(
        Eigen::Map<const Eigen::VectorXi>(order.data(), Eigen::Index(order.size())));
    const MatrixXd back = permutation.transpose() * MatrixXd(result.laplacian) * permutation;
    EXPECT_LT(LargestDifference(back, expected.laplacian), 1e-9) << seed;
    EXPECT_LT(LargestDifference(permutation.transpose() * result.areas, expected.areas), 1e-9);
  }
}

TEST(RobustLaplacian, RigidMotionAndScale_DoNotMatter) {
  for (uint32_t seed = 0; seed < 10; ++seed) {
    const SolveMesh mesh = seed == 0 ? test::MakeBlob(9, 7) : test::MakeSoup(14, 30, seed);
    const RobustLaplacian expected = MakeRobustLaplacian(mesh);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
    for (const double scale : {1e-100, 1e-6, 1.0, 1e6, 1e100}) {
      SolveMesh moved = mesh;
      moved.shapes[0] =
          (scale * mesh.shapes[0] * turn).rowwise() + scale * Eigen::RowVector3d(0.3, -2, 1);
      const RobustLaplacian result = MakeRobustLaplacian(moved);
      EXPECT_LT(LargestDifference(result.laplacian, expected.laplacian), 1e-8);
      EXPECT_LT(LargestDifference(result.areas / scale / scale, expected.areas), 1e-9);
    }
  }
}

TEST(RobustLaplacian, SameInput_SameBits) {
  const SolveMesh mesh = BrokenMesh(4);
  const RobustLaplacian one = MakeRobustLaplacian(mesh), other = MakeRobustLaplacian(mesh);
  EXPECT_EQ(MatrixXd(one.laplacian), MatrixXd(other.laplacian));
  EXPECT_EQ(one.areas, other.areas);
}

TEST(RobustLaplacian, DegenerateTriangles_StayBounded) {
  SolveMesh mesh = test::MakeGrid(3, 3);
  mesh.triangles.push_back({0, 1, 2});            // in line
  mesh.triangles.push_back({0, 5, 15});           // in line, over a diagonal
  mesh.shapes[0].row(6) = mesh.shapes[0].row(5);  // an edge of no length
  test::Append(test::MakeGrid(1, 1), {9, 9, 9}, &mesh);
  for (int v = 16; v < 20; ++v)
    mesh.shapes[0].row(v) << 9, 9, 9;  // a patch of no size
  ConnectComponents(&mesh);
  const RobustLaplacian result = MakeRobustLaplacian(mesh);
  ExpectSound(result);
  EXPECT_GT(Eigenvalues(result.laplacian)(1), 1e-4);
  // No pair of vertices pulls harder than kLargestWeight for each edge between them.
  EXPECT_LT(result.laplacian.diagonal().maxCoeff(), 20 * kLargestWeight);
  // The part without size does not change the rest, which is bad enough.
  EXPECT_NEAR(result.areas.sum(), 9, 0.1);
}

TEST(RobustLaplacian, VertexThatHangsByANeedle_IsHeld) {
  SolveMesh mesh = test::MakeGrid(3, 3);
  const MatrixXd grid = Dense(mesh);
  mesh.shapes[0].conservativeResize(18, 3);
  mesh.shapes[0].row(16) = mesh.shapes[0].row(5);
  mesh.shapes[0].row(17) << 1, 1, 2;
  mesh.triangles.push_back({5, 16, 17});
  const MatrixXd laplacian = Dense(mesh);
  EXPECT_NEAR(laplacian(17, 17), kSmallestHold, 1e-12);
  EXPECT_NEAR(laplacian(5, 17), -kSmallestHold / 2, 1e-12);
  // The vertices in one place move as one, and the surface feels no more than the hold.
  EXPECT_NEAR(laplacian(5, 16), -kLargestWeight / 2, 0.1);  // an open edge
  MatrixXd rest = laplacian.topLeftCorner(16, 16) - grid;
  rest(5, 5) -= kLargestWeight / 2;
  EXPECT_LT(rest.cwiseAbs().maxCoeff(), 1.1 * kSmallestHold);
}

TEST(RobustLaplacian, AllInOnePlace_IsThatOfEquilateralTriangles) {
  SolveMesh mesh = test::MakeIcosphere(0);
  const MatrixXd expected = Dense(mesh);
  mesh.shapes[0].setConstant(-4);
  const RobustLaplacian result = MakeRobustLaplacian(mesh);
  EXPECT_LT(LargestDifference(result.laplacian, expected), 1e-12);
  EXPECT_GT(result.areas.minCoeff(), 0);
}

TEST(RobustLaplacian, UnusableTriangles_CountAsAbsent) {
  const SolveMesh mesh = test::MakeBlob(6, 4);
  const RobustLaplacian expected = MakeRobustLaplacian(mesh);
  SolveMesh broken = mesh;
  test::Append(test::MakeGrid(1, 1), {0, 0, 0}, &broken);
  const int first = mesh.num_vertices();
  broken.shapes[0](first, 1) = std::nan("");
  broken.shapes[0](first + 3, 0) = std::numeric_limits<double>::infinity();
  broken.triangles.push_back({0, 0, 1});
  const RobustLaplacian result = MakeRobustLaplacian(broken);
  ExpectSound(result);
  EXPECT_EQ(MatrixXd(result.laplacian).topLeftCorner(first, first), MatrixXd(expected.laplacian));
  EXPECT_EQ(result.laplacian.nonZeros(), expected.laplacian.nonZeros() + 4);  // four zeros
}

TEST(RobustLaplacian, Bridges_AddTheirWeights) {
  SolveMesh mesh = test::MakeGrid(2, 2);
  test::Append(test::MakeBlob(4, 2), {5, 0, 0}, &mesh);
  MatrixXd expected = Dense(mesh);
  EXPECT_EQ(NumParts(mesh), 2);
  ConnectComponents(&mesh);
  ASSERT_FALSE(mesh.bridges.empty());
  for (const Bridge& bridge : mesh.bridges) {
    const VectorXd difference =
        VectorXd::Unit(expected.rows(), bridge.a) - VectorXd::Unit(expected.rows(), bridge.b);
    expected += bridge.weight * difference * difference.transpose();
  }
  EXPECT_LT(LargestDifference(Dense(mesh), expected), 1e-12);
}

TEST(RobustLaplacian, NoTriangles_IsBridgesOnly) {
  SolveMesh mesh;
  EXPECT_EQ(MakeRobustLaplacian(mesh).areas.size(), 0);
  mesh.shapes = {PointMatrix::Zero(2, 3)};
  mesh.bridges = {{0, 1, 2.5}};
  const RobustLaplacian result = MakeRobustLaplacian(mesh);
  Eigen::Matrix2d expected;
  expected << 2.5, -2.5, -2.5, 2.5;
  EXPECT_EQ(MatrixXd(result.laplacian), expected);
  EXPECT_EQ(result.areas, VectorXd::Ones(2));
}

}  // namespace
}  // namespace limber::geometry
