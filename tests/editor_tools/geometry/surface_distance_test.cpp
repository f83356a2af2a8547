// Paths over the surface against their exact lengths where these are known.
#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"
#include "geometry/geodesic.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

namespace limber::geometry {
namespace {

constexpr double kPi = std::numbers::pi;

// A sheet of columns x rows squares whose inner vertices are moved at random by up to `jitter`.
SolveMesh MakeSheet(int columns, int rows, double jitter) {
  SolveMesh mesh = test::MakeGrid(columns, rows);
  std::mt19937 random(7);
  for (int y = 1; y < rows; ++y) {
    for (int x = 1; x < columns; ++x) {
      for (int axis = 0; axis < 2; ++axis) {
        const double unit = static_cast<double>(random()) / 4294967295.0;
        mesh.shapes[0](y * (columns + 1) + x, axis) += jitter * (2 * unit - 1);
      }
    }
  }
  return mesh;
}

// A sphere of radius 1 of `around` meridians; poles are the last two vertices.
SolveMesh MakeSphere(int around, int rings) {
  SolveMesh mesh = test::MakeBlob(around, rings);
  mesh.shapes[0].rowwise().normalize();
  return mesh;
}

using Exact = std::function<double(int, int)>;

// The least and the largest of (distance - exact) / exact, from some vertices to all whose exact
// distance is at most `farthest` and not zero.
struct Errors {
  double low = 0, high = 0;
};

Errors Measure(const SolveMesh& mesh, double farthest, const Exact& exact) {
  const SurfaceDistance surface(mesh, 0);
  Errors errors;
  const int step = std::max(1, mesh.num_vertices() / 17);
  for (int source = 0; source < mesh.num_vertices(); source += step) {
    const Eigen::VectorXd distance = surface.From(source);
    for (int v = 0; v < mesh.num_vertices(); ++v) {
      const double length = exact(source, v);
      if (v == source || !(length > 0) || length > farthest) continue;
      const double error = distance(v) / length - 1;
      errors.low = std::min(errors.low, error);
      errors.high = std::max(errors.high, error);
    }
  }
  return errors;
}

TEST(SurfaceDistance, Plane_IsExactWhateverTheTriangles) {
  for (const double jitter : {0.0, 0.2, 0.3}) {
    const SolveMesh sheet = MakeSheet(30, 20, jitter);
    const Errors errors = Measure(sheet, 1e9, [&sheet](int a, int b) {
      return (sheet.shapes[0].row(a) - sheet.shapes[0].row(b)).norm();
    });
    EXPECT_GT(errors.low, -1e-12) << jitter;
    EXPECT_LT(errors.high, 1e-7) << jitter;
  }
}

// The sheet rolled up: straight lines of the unrolled sheet, once around or not.
TEST(SurfaceDistance, Cylinder_IsThatOfTheUnrolledSheet) {
  const int around = 40, along = 30;
  SolveMesh flat = MakeSheet(around, along, 0.2), rolled = flat;
  const double edge = 2 * std::sin(kPi / around);
  // Straight between its vertices, a rolled triangle is that of the prism, not of the cylinder.
  for (int v = 0; v < flat.num_vertices(); ++v) {
    const int x = v % (around + 1), y = v / (around + 1);
    const double angle = 2 * kPi * x / around;
    flat.shapes[0].row(v) << edge * x, 0.1 * y, 0;
    rolled.shapes[0].row(v) << std::cos(angle), 0.1 * y, std::sin(angle);
  }
  for (auto& triangle : rolled.triangles) {
    for (int& v : triangle)
      v -= v % (around + 1) == around ? around : 0;  // the seam is closed
  }
  const Errors errors = Measure(rolled, 1e9, [&flat, edge](int a, int b) {
    const auto is_closed = [](int v) { return v % (around + 1) == around; };
    if (is_closed(a) || is_closed(b)) return 0.0;
    const Eigen::RowVector3d turn(around * edge, 0, 0);
    const Eigen::RowVector3d way = flat.shapes[0].row(b) - flat.shapes[0].row(a);
    return std::min({way.norm(), (way - turn).norm(), (way + turn).norm()});
  });
  EXPECT_GT(errors.low, -0.01);  // where two ways around are equally long
  EXPECT_LT(errors.high, 1e-7);
}

TEST(SurfaceDistance, Sphere_ErrorHalvesWithTheTriangles) {
  for (const int around : {24, 48, 96}) {
    const SolveMesh sphere = MakeSphere(around, around / 2 - 1);
    const Exact exact = [&sphere](int a, int b) {
      const Eigen::Vector3d p = sphere.shapes[0].row(a), q = sphere.shapes[0].row(b);
      return std::atan2(p.cross(q).norm(), p.dot(q));
    };
    const Errors near = Measure(sphere, kPi / 2, exact), all = Measure(sphere, kPi, exact);
    EXPECT_GT(near.low, -0.65 / around);
    EXPECT_GT(all.low, -2.2 / around);
    EXPECT_LE(all.high, 0);
  }
}

// Round the inner corner of an L no straight line leads.
TEST(SurfaceDistance, Corner_IsRoundedAtLittleExcess) {
  const int half = 24, row = 2 * half + 1;
  SolveMesh mesh = test::MakeGrid(2 * half, 2 * half);
  const PointMatrix& points = mesh.shapes[0];
  std::erase_if(mesh.triangles, [&points](const std::array<int, 3>& triangle) {
    return std::any_of(triangle.begin(), triangle.end(),
                       [&](int v) { return points(v, 0) > half && points(v, 1) > half; });
  });
  const Eigen::RowVector3d corner(half, half, 0), from(0, 2 * half, 0);
  const Eigen::VectorXd distance = SurfaceDistance(mesh, 0).From(2 * half * row);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    const Eigen::RowVector3d to = points.row(v);
    if (to.x() > half && to.y() > half) continue;
    const bool around = to.x() + to.y() > 2 * half && to.x() > half;
    const double exact =
        around ? (corner - from).norm() + (to - corner).norm() : (to - from).norm();
    EXPECT_GE(distance(v), exact - 1e-9);
    EXPECT_LE(distance(v), 1.01 * exact + 1e-9);
  }
}

TEST(SurfaceDistance, NeverLongerThanAlongEdges_NorDependentOnNumbersOrScale) {
  const SolveMesh blob = test::MakeBlob(20, 16);
  const Eigen::VectorXd distance = SurfaceDistance(blob, 0).From(5);
  EXPECT_LE((distance - EdgeGraph(blob).Distances(std::array{5})).maxCoeff(), 1e-12);
  const Vector<int> order = test::Shuffle(blob.num_vertices(), 3);
  SolveMesh other = test::Renumbered(blob, order);
  other.shapes[0] *= 1000;
  const Eigen::VectorXd renamed = SurfaceDistance(other, 0).From(order[5]);
  for (int v = 0; v < blob.num_vertices(); ++v)
    EXPECT_NEAR(renamed(order[v]), 1000 * distance(v), 1e-6 * (1 + 1000 * distance(v)));
}

TEST(SurfaceDistance, EachShape_HasItsOwnAndBridgesLead) {
  SolveMesh mesh = test::MakeGrid(4, 4);
  test::Append(test::MakeGrid(4, 4), {7, 0, 0}, &mesh);
  mesh.shapes.push_back(2 * mesh.shapes[0]);
  EXPECT_EQ(SurfaceDistance(mesh, 0).From(0)(25), std::numeric_limits<double>::infinity());
  mesh.bridges = {{25, 4, 1.0}};  // from (4, 0) to (7, 0)
  EXPECT_NEAR(SurfaceDistance(mesh, 0).From(0)(25), 7, 1e-12);
  EXPECT_NEAR(SurfaceDistance(mesh, 1).From(0)(25), 14, 1e-12);
  EXPECT_NEAR(SurfaceDistance(mesh, 1).From(0)(24), 2 * std::hypot(4, 4), 1e-12);
}

}  // namespace
}  // namespace limber::geometry
