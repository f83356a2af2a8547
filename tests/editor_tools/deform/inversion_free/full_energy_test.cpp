#include "deform/inversion_free/full_energy.h"

#include "made_elements.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <random>

namespace limber::deform {
namespace {

using test::kDegree;

template <int D>
typename SimplexMesh<D>::Positions Disturbed(const typename SimplexMesh<D>::Positions& x,
                                             double size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, size);
  typename SimplexMesh<D>::Positions moved = x;
  for (Eigen::Index i = 0; i < moved.size(); ++i)
    moved.data()[i] += noise(random);
  return moved;
}

// Large enough a disturbance that some elements are inside out.
template <int D>
void ExpectDerivatives(const InversionFreeProblem<D>& problem, const InversionFreeOptions& options,
                       double disturbance) {
  const auto energy = FullEnergy<D>::Create(problem, options);
  ASSERT_TRUE(energy.ok()) << energy.status().message();
  const auto x = Disturbed<D>(problem.mesh.rest, disturbance, 1);
  const double tau = 3;
  const Eigen::VectorXd gradient = energy->GradientAt(x, tau);
  const Eigen::SparseMatrix<double> hessian = energy->HessianAt(x, tau);
  EXPECT_LT((Eigen::MatrixXd(hessian) - Eigen::MatrixXd(hessian).transpose()).norm(),
            1e-12 * hessian.norm());
  std::mt19937 random(2);
  std::normal_distribution<double> noise;
  for (int trial = 0; trial < 10; ++trial) {
    typename SimplexMesh<D>::Positions direction = x;
    for (Eigen::Index i = 0; i < direction.size(); ++i)
      direction.data()[i] = noise(random);
    const Eigen::Map<const Eigen::VectorXd> along(direction.data(), direction.size());
    const double h = 1e-6;
    const double slope =
        (energy->Value(x + h * direction, tau) - energy->Value(x - h * direction, tau)) / (2 * h);
    EXPECT_NEAR(slope, gradient.dot(along), 1e-6 * gradient.norm());
    const Eigen::VectorXd change =
        (energy->GradientAt(x + h * direction, tau) - energy->GradientAt(x - h * direction, tau)) /
        (2 * h);
    const Eigen::VectorXd expected = hessian * along;
    EXPECT_LT((change - expected).norm(), 2e-5 * expected.norm());
  }
}

TEST(FullEnergy, Derivatives_AreThoseOfTheValue) {
  for (const PenaltyKind kind :
       {PenaltyKind::kQuadratic, PenaltyKind::kCubic, PenaltyKind::kSpline}) {
    InversionFreeOptions options;
    options.penalty = kind;
    options.target_weight = 10;
    options.incompressibility = 0.7;
    const TriangleMesh grid = test::MakeGrid(4);
    ExpectDerivatives(
        test::MakeProblem(grid, test::Swirl(grid, 90 * kDegree), HandleWeightKind::kHarmonic),
        options, 0.2);
    const TetMesh bar = test::MakeBar(2, 2, 3);
    ExpectDerivatives(
        test::MakeProblem(bar, test::TwistBar(bar, 120 * kDegree), HandleWeightKind::kHarmonic),
        options, 0.2);
  }
}

// Where eigenvalues coincide the vectors are arbitrary, and the Hessian is not.
TEST(FullEnergy, RepeatedEigenvalues_HaveAHessianAllTheSame) {
  const TetMesh bar = test::MakeBar(1, 1, 1);
  InversionFreeProblem<3> problem =
      test::MakeProblem(bar, test::TwistBar(bar, 0), HandleWeightKind::kHarmonic);
  const auto energy = FullEnergy<3>::Create(problem, {});
  ASSERT_TRUE(energy.ok());
  for (const double scale : {-0.5, 0.0}) {  // three equal ones, all negative, or zero
    const TetMesh::Positions x = scale * bar.rest;
    const Eigen::MatrixXd at = energy->HessianAt(x, 100);
    ASSERT_TRUE(at.allFinite());
    const Eigen::MatrixXd beside = energy->HessianAt(Disturbed<3>(x, 1e-7, 5), 100);
    if (scale < 0) {
      EXPECT_LT((at - beside).norm(), 1e-4 * at.norm());
    }
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(at).eigenvalues();
    EXPECT_GT(values[0], 0);
  }
}

TEST(FullEnergy, IsConvex) {
  const TetMesh bar = test::MakeBar(2, 2, 3);
  const auto problem =
      test::MakeProblem(bar, test::TwistBar(bar, 180 * kDegree), HandleWeightKind::kHarmonic);
  const auto energy = FullEnergy<3>::Create(problem, {});
  ASSERT_TRUE(energy.ok());
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto a = Disturbed<3>(bar.rest, 0.4, seed), b = Disturbed<3>(bar.rest, 0.4, seed + 100);
    for (const double tau : {0.0, 1.0, 1e6}) {
      const double middle = energy->Value(0.5 * (a + b), tau);
      EXPECT_LE(middle, 0.5 * (energy->Value(a, tau) + energy->Value(b, tau)) * (1 + 1e-12));
    }
  }
}

TEST(FullEnergy, MovedWithItsWishes_CostsTheSame) {
  const TetMesh bar = test::MakeBar(2, 2, 3);
  auto problem =
      test::MakeProblem(bar, test::TwistBar(bar, 90 * kDegree), HandleWeightKind::kHarmonic);
  InversionFreeOptions options;
  options.incompressibility = 2;
  const auto x = Disturbed<3>(bar.rest, 0.3, 7);
  const auto energy = FullEnergy<3>::Create(problem, options);
  ASSERT_TRUE(energy.ok());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  const Eigen::RowVector3d shift(4, 5, 6);
  for (Eigen::Matrix3d& rotation : problem.rotations)
    rotation = turn * rotation;
  problem.targets = (problem.targets * turn.transpose()).rowwise() + shift;
  const auto moved = FullEnergy<3>::Create(problem, options);
  ASSERT_TRUE(moved.ok()) << moved.status().message();
  const TetMesh::Positions moved_x = (x * turn.transpose()).rowwise() + shift;
  EXPECT_NEAR(moved->Value(moved_x, 10), energy->Value(x, 10), 1e-9 * energy->Value(x, 10));
}

TEST(FullEnergy, WhatMakesNoSense_IsRefused) {
  const TetMesh bar = test::MakeBar(2, 2, 2);
  const auto good = test::MakeProblem(bar, test::TwistBar(bar, 0), HandleWeightKind::kHarmonic);
  const auto code = [](const InversionFreeProblem<3>& problem,
                       const InversionFreeOptions& options = {}) {
    return FullEnergy<3>::Create(problem, options).status().code();
  };
  EXPECT_EQ(code(good), StatusCode::kOk);
  auto bad = good;
  bad.rotations.pop_back();
  EXPECT_EQ(code(bad), StatusCode::kInvalidArgument);
  bad = good;
  bad.rotations[3] *= 1.1;
  EXPECT_EQ(code(bad), StatusCode::kInvalidArgument);
  bad = good;
  bad.rotations[3] = -Eigen::Matrix3d::Identity();
  EXPECT_EQ(code(bad), StatusCode::kInvalidArgument);
  bad = good;
  bad.target_vertices[1] = bad.target_vertices[0];
  EXPECT_EQ(code(bad), StatusCode::kInvalidArgument);
  bad = good;
  bad.target_vertices[1] = 27;
  EXPECT_EQ(code(bad), StatusCode::kInvalidArgument);
  bad = good;
  bad.targets(0, 0) = NAN;
  EXPECT_EQ(code(bad), StatusCode::kInvalidArgument);
  bad = good;
  bad.target_vertices.clear();
  EXPECT_EQ(code(bad), StatusCode::kInvalidArgument);
  InversionFreeOptions options;
  options.target_weight = 0;
  EXPECT_EQ(code(good, options), StatusCode::kInvalidArgument);
  options = {};
  options.smallest_stretch = NAN;
  EXPECT_EQ(code(good, options), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace limber::deform
