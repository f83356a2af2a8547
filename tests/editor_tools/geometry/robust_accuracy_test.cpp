// What the robust Laplacian is for: right answers on badly triangulated surfaces.
#include "core/vector.h"
#include "editor_tools/geometry/soup_meshes.h"
#include "geometry/cotangent.h"
#include "geometry/robust_laplacian.h"

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace limber::geometry {
namespace {

using Eigen::VectorXd;

// A unit square of which nothing but the vertices is well chosen.
SolveMesh BadSquare(int n) {
  return test::RandomlyFlipped(test::MakeJitteredSquare(n, 7), 40 * n * n, 8);
}

TEST(RobustLaplacian, PlanarMesh_ReproducesLinearFunctions) {
  const SolveMesh square = test::MakeJitteredSquare(12, 2);
  const VectorXd linear = square.shapes[0] * Eigen::Vector3d(2, -3, 0);
  const VectorXd result = MakeRobustLaplacian(square).laplacian * linear;
  const Vector<bool> on_outline = test::OnOutline(square);
  for (int v = 0; v < square.num_vertices(); ++v) {
    if (on_outline[v]) continue;
    EXPECT_NEAR(result(v), 0, 1e-13);
  }
}

TEST(RobustLaplacian, HarmonicFunctionOnABadMesh_IsLinearWhereTheClampedOneIsNot) {
  const SolveMesh square = BadSquare(14);
  const Vector<bool> on_outline = test::OnOutline(square);
  const VectorXd linear = square.shapes[0] * Eigen::Vector3d(1, 0.5, 0);
  const VectorXd zero = VectorXd::Zero(linear.size());
  const auto error = [&](const Eigen::SparseMatrix<double>& laplacian) {
    return (test::SolveWithFixed(laplacian, zero, on_outline, linear) - linear)
        .lpNorm<Eigen::Infinity>();
  };
  EXPECT_LT(error(MakeRobustLaplacian(square).laplacian), 1e-10);
  EXPECT_GT(error(CotangentLaplacian(square)), 1e-2);
}

TEST(RobustLaplacian, PoissonProblemOnABadMesh_Converges) {
  // -laplace u = 2 pi^2 sin(pi x) sin(pi y), zero on the outline: u = sin(pi x) sin(pi y).
  Vector<double> errors;
  for (const int n : {6, 12, 24}) {
    const SolveMesh square = BadSquare(n);
    const auto points = square.shapes[0].array() * std::numbers::pi;
    const VectorXd exact = points.col(0).sin() * points.col(1).sin();
    const RobustLaplacian robust = MakeRobustLaplacian(square);
    const VectorXd right_side =
        2 * std::pow(std::numbers::pi, 2) * robust.areas.cwiseProduct(exact);
    const VectorXd solution = test::SolveWithFixed(
        robust.laplacian, right_side, test::OnOutline(square), VectorXd::Zero(exact.size()));
    errors.push_back(
        std::sqrt((solution - exact).cwiseAbs2().dot(robust.areas) / robust.areas.sum()));
  }
  EXPECT_LT(errors[0], 0.05);
  EXPECT_LT(errors[1], errors[0] / 3);  // a quarter, as the cells halve
  EXPECT_LT(errors[2], errors[1] / 3);
}

// A sphere cut like an orange: the fewer the rings, the thinner the triangles.
SolveMesh MakeOrange(int around, int rings) {
  SolveMesh mesh = test::MakeBlob(around, rings);
  mesh.shapes[0].rowwise().normalize();
  return mesh;
}

TEST(RobustLaplacian, SphereOfNeedles_FirstEigenvalueConverges) {
  // The coordinates are eigenfunctions of the unit sphere, of eigenvalue 2.
  Vector<double> errors;
  for (const int rings : {6, 12, 24}) {
    const SolveMesh sphere = MakeOrange(6 * rings, rings);
    const RobustLaplacian robust = MakeRobustLaplacian(sphere);
    const Eigen::SparseMatrix<double> mass(Eigen::SparseMatrix<double>(robust.areas.asDiagonal()));
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(robust.laplacian + 0.1 * mass);
    ASSERT_EQ(factor.info(), Eigen::Success);
    VectorXd u =
        sphere.shapes[0] * Eigen::Vector3d(0.6, 0.5, -0.7) + sphere.shapes[0].col(0).cwiseAbs2();
    for (int i = 0; i < 60; ++i) {
      u.array() -= robust.areas.dot(u) / robust.areas.sum();
      u = factor.solve(mass * u);
      u /= std::sqrt(u.cwiseAbs2().dot(robust.areas));
    }
    errors.push_back(std::abs(u.dot(robust.laplacian * u) - 2));
  }
  EXPECT_LT(errors[0], 0.2);
  EXPECT_LT(errors[1], errors[0] / 3);
  EXPECT_LT(errors[2], errors[1] / 3);
}

}  // namespace
}  // namespace limber::geometry
