#include "geometry/intrinsic_delaunay.h"

#include "editor_tools/geometry/soup_meshes.h"
#include "geometry/tufted_cover.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace limber::geometry {
namespace {

constexpr int64_t kAnyNumber = 1 << 20;

IntrinsicTriangulation CoverOf(const SolveMesh& mesh) {
  return TuftedCover(mesh.shapes[0], mesh.triangles,
                     MollifiedLengths(mesh.shapes[0], mesh.triangles));
}

double TotalArea(const IntrinsicTriangulation& triangulation) {
  double area = 0;
  for (int h = 0; h < triangulation.num_halfedges(); ++h)
    area += OppositeCotangent(triangulation, h) * std::pow(triangulation.length[h], 2) / 4;
  return area;
}

double LeastWeight(const IntrinsicTriangulation& triangulation) {
  double least = 1;
  for (int h = 0; h < triangulation.num_halfedges(); ++h)
    least = std::min(least, CotangentWeight(triangulation, h));
  return least;
}

// Faces by their corners, ascending.
std::multiset<std::array<int, 3>> Faces(const IntrinsicTriangulation& triangulation) {
  std::multiset<std::array<int, 3>> faces;
  for (int h = 0; h < triangulation.num_halfedges(); h += 3) {
    std::array<int, 3> face = {triangulation.tail[h], triangulation.tail[h + 1],
                               triangulation.tail[h + 2]};
    std::sort(face.begin(), face.end());
    faces.insert(face);
  }
  return faces;
}

TEST(OppositeCotangent, KnownAngles) {
  const double root = std::sqrt(3.0);
  IntrinsicTriangulation triangle{{0, 1, 2}, {}, {1, root, 2}};  // opposite 30, 60, 90 degrees
  EXPECT_NEAR(OppositeCotangent(triangle, 0), root, 1e-14);
  EXPECT_NEAR(OppositeCotangent(triangle, 1), 1 / root, 1e-14);
  EXPECT_NEAR(OppositeCotangent(triangle, 2), 0, 1e-14);
  triangle.length = {1, 2, 3};  // no area
  for (int h = 0; h < 3; ++h)
    EXPECT_TRUE(std::isfinite(OppositeCotangent(triangle, h)));
}

TEST(FlipEdge, Once_KeepsAreaAndGlue_TwiceGivesBackTheTriangulation) {
  for (const SolveMesh& mesh : {test::MakeBlob(7, 5), test::MakeSoup(7, 15, 3)}) {
    IntrinsicTriangulation cover = CoverOf(mesh);
    const double area = TotalArea(cover);
    int num_flipped = 0;
    for (int h = 0; h < cover.num_halfedges(); ++h) {
      const auto faces = Faces(cover);
      const double length = cover.length[h];
      if (!FlipEdge(h, &cover)) continue;
      ++num_flipped;
      EXPECT_NEAR(TotalArea(cover), area, 1e-10);
      for (int g = 0; g < cover.num_halfedges(); ++g) {
        ASSERT_NE(cover.twin[g], g);
        ASSERT_EQ(cover.twin[cover.twin[g]], g);
        ASSERT_EQ(cover.tail[cover.twin[g]], cover.tail[Next(g)]);
        ASSERT_EQ(cover.length[cover.twin[g]], cover.length[g]);
      }
      ASSERT_TRUE(FlipEdge(Next(h), &cover));
      EXPECT_EQ(Faces(cover), faces);
      EXPECT_NEAR(cover.length[Previous(h)], length, 1e-10);
    }
    EXPECT_GT(num_flipped, 40);
  }
}

TEST(FlipToDelaunay, PlanarMesh_EndsAtTheDelaunayTriangulation) {
  // Whatever the triangulation of the square, no circle of three corners holds a fourth vertex.
  const SolveMesh square = test::MakeJitteredSquare(8, 4);
  IntrinsicTriangulation straight = CoverOf(square);
  ASSERT_TRUE(FlipToDelaunay(kAnyNumber, &straight));
  IntrinsicTriangulation cover = CoverOf(test::RandomlyFlipped(square, 2000, 9));
  ASSERT_NE(Faces(cover), Faces(straight));
  ASSERT_TRUE(FlipToDelaunay(kAnyNumber, &cover));
  EXPECT_EQ(Faces(cover), Faces(straight));
  for (const auto& [a, b, c] : Faces(cover)) {
    const auto point = [&](int v) { return Eigen::Vector2d(square.shapes[0].row(v).head<2>()); };
    const auto lifted = [&](int v) {
      const Eigen::Vector2d from_a = point(v) - point(a);
      return Eigen::Vector3d(from_a.x(), from_a.y(), from_a.squaredNorm());
    };
    const double side = lifted(b).head<2>().dot(
        Eigen::Vector2d(lifted(c).y(), -lifted(c).x()));  // twice the area, signed
    for (int v = 0; v < square.num_vertices(); ++v) {
      const double above = lifted(v).dot(lifted(b).cross(lifted(c)));
      EXPECT_GE(above * side, -1e-12);
    }
  }
}

TEST(FlipToDelaunay, AnySoup_EndsWithoutNegativeWeights) {
  for (uint32_t seed = 0; seed < 30; ++seed) {
    SolveMesh mesh = test::MakeSoup(8 + int(seed), 50, seed);
    test::Spoil(seed, &mesh);
    IntrinsicTriangulation cover = CoverOf(mesh);
    const double area = TotalArea(cover);
    EXPECT_LT(LeastWeight(cover), -0.1);
    EXPECT_TRUE(FlipToDelaunay(kAnyNumber, &cover));
    EXPECT_GT(LeastWeight(cover), -1e-7);
    EXPECT_NEAR(TotalArea(cover), area, 1e-6 * area);
  }
}

TEST(FlipToDelaunay, CocircularCorners_StayAsTheyAre) {
  SolveMesh mesh = test::RandomlyFlipped(test::MakeGrid(9, 7), 500, 2);
  mesh.shapes[0] *= Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix() / 3;
  IntrinsicTriangulation cover = CoverOf(mesh);
  ASSERT_TRUE(FlipToDelaunay(kAnyNumber, &cover));
  const IntrinsicTriangulation first = cover;
  ASSERT_TRUE(FlipToDelaunay(0, &cover));
  EXPECT_EQ(cover.tail, first.tail);
  EXPECT_EQ(cover.length, first.length);
}

TEST(FlipToDelaunay, ObtuseTriangleAlone_GrowsALoop) {
  // Front and back of a triangle whose angle at vertex 2 is obtuse: the long side makes room for an
  // edge from vertex 2 around to itself, twice as long as the height.
  SolveMesh mesh;
  Eigen::Matrix3d corners;
  corners << -1, 0, 0, 1, 0, 0, 0, 0.25, 0;
  mesh.shapes = {corners};
  mesh.triangles = {{0, 1, 2}};
  IntrinsicTriangulation cover = CoverOf(mesh);
  const double unit = MollifiedLengths(mesh.shapes[0], mesh.triangles).unit;
  ASSERT_TRUE(FlipToDelaunay(1, &cover));
  EXPECT_EQ(Faces(cover), (std::multiset<std::array<int, 3>>{{0, 2, 2}, {1, 2, 2}}));
  for (int h = 0; h < 6; ++h) {
    if (cover.tail[h] != cover.tail[Next(h)]) {
      EXPECT_FALSE(FlipEdge(h, &cover));  // one face on both sides
    } else {
      EXPECT_NEAR(cover.length[h] * unit, 0.5, 1e-12);
    }
  }
}

TEST(FlipToDelaunay, TorusOfOneVertex_FindsTheShortestVectors) {
  // The plane modulo the lattice of (1, 0) and (0.3, 0.9), of two triangles: every side of the one
  // is glued to the other. From a skew basis flips reduce the lattice as Gauss does.
  const double shortest[3] = {std::hypot(0.3, 0.9), 1, std::hypot(0.7, 0.9)};
  for (const int skew : {-40, -7, 0, 5, 100}) {
    const double u = 1, v = std::hypot(0.3 + skew, 0.9), w = std::hypot(1.3 + skew, 0.9);
    IntrinsicTriangulation torus{{0, 0, 0, 0, 0, 0}, {3, 4, 5, 0, 1, 2}, {u, v, w, u, v, w}};
    ASSERT_TRUE(FlipToDelaunay(kAnyNumber, &torus));
    for (int h = 0; h < 6; ++h)
      ASSERT_EQ(torus.twin[torus.twin[h]], h);
    EXPECT_NEAR(TotalArea(torus), 0.9, 1e-8);
    std::sort(torus.length.begin(), torus.length.end());
    for (size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(torus.length[i], shortest[i / 2], 1e-8) << skew;
  }
}

TEST(FlipToDelaunay, StopsAtTheLimitAndGoesOnFromThere) {
  IntrinsicTriangulation cover = CoverOf(test::MakeSoup(20, 60, 1));
  IntrinsicTriangulation stepwise = cover;
  EXPECT_FALSE(FlipToDelaunay(3, &stepwise));
  int num_steps = 1;
  while (!FlipToDelaunay(3, &stepwise))
    ASSERT_LT(++num_steps, 10000);
  EXPECT_GT(num_steps, 5);
  ASSERT_TRUE(FlipToDelaunay(kAnyNumber, &cover));
  EXPECT_EQ(Faces(stepwise), Faces(cover));
}

}  // namespace
}  // namespace limber::geometry
