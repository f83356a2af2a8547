#include "core/rotation_fit.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace limber {
namespace {

template <class Matrix>
void ExpectRotation(const Matrix& r) {
  EXPECT_LT((r * r.transpose() - Matrix::Identity()).norm(), 1e-12);
  EXPECT_NEAR(r.determinant(), 1, 1e-12);
}

TEST(FitRotation3, RandomMatrices_NoRotationNearbyDoesBetter) {
  srand(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix3d m = Eigen::Matrix3d::Random();
    const Eigen::Matrix3d r = FitRotation<3>(m);
    ExpectRotation(r);
    const double best = (r * m).trace();
    for (int i = 0; i < 20; ++i) {
      const Eigen::AngleAxisd turn(0.1 * i, Eigen::Vector3d::Random().normalized());
      EXPECT_LE((turn.toRotationMatrix() * r * m).trace(), best + 1e-12);
    }
  }
}

TEST(FitRotation3, RotatedGram_GivesTheRotationBack) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.9, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Matrix3d gram = Eigen::Vector3d(3, 2, 1e-3).asDiagonal();
  // tr(R gram turn^T) is largest for R = turn.
  EXPECT_LT((FitRotation<3>(gram * turn.transpose()) - turn).norm(), 1e-9);
}

TEST(FitRotation3, ReflectionsAndRankDefects_StayRotations) {
  ExpectRotation(FitRotation<3>(-Eigen::Matrix3d::Identity()));
  ExpectRotation(FitRotation<3>(Eigen::Vector3d(1, 1, -1).asDiagonal()));
  ExpectRotation(FitRotation<3>(Eigen::Vector3d(1, 0, 0).asDiagonal()));
  ExpectRotation(FitRotation<3>(Eigen::Matrix3d::Constant(1e-200)));
  EXPECT_EQ(FitRotation<3>(Eigen::Matrix3d::Zero()), Eigen::Matrix3d::Identity());
}

TEST(FitRotation2, RandomMatrices_NoRotationDoesBetter) {
  srand(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix2d m = Eigen::Matrix2d::Random();
    const Eigen::Matrix2d r = FitRotation<2>(m);
    ExpectRotation(r);
    for (int i = 0; i < 64; ++i) {
      const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.1 * i).toRotationMatrix();
      EXPECT_LE((turn * m).trace(), (r * m).trace() + 1e-12);
    }
  }
  EXPECT_EQ(FitRotation<2>(Eigen::Matrix2d::Zero()), Eigen::Matrix2d::Identity());
}

}  // namespace
}  // namespace limber
