#include "deform/inversion_free/handle_motion.h"

#include "made_elements.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace limber::deform {
namespace {

using test::kDegree;

// The rotation of an element whose corners follow the second handle that much.
Eigen::Matrix3d BlendAt(double share, const Turn<3>& turn) {
  const TetMesh mesh = test::MakeBar(1, 1, 1);
  Vector<HandleMotion<3>> handles(2);
  handles[1].turn = turn;
  Eigen::MatrixXd weights(mesh.num_vertices(), 2);
  weights.col(1).setConstant(share);
  weights.col(0).setConstant(1 - share);
  return BlendRotations(mesh, handles, weights)[0];
}

TEST(HandleMotion, Apply_TurnsAboutThePivot) {
  HandleMotion<3> handle;
  handle.pivot = {1, 0, 0};
  handle.turn = {0, 0, 90 * kDegree};
  handle.translation = {0, 0, 5};
  EXPECT_LT((handle.Apply({2, 0, 0}) - Eigen::Vector3d(1, 1, 5)).norm(), 1e-12);
  HandleMotion<2> flat;
  flat.turn[0] = -90 * kDegree;
  EXPECT_LT((flat.Apply({0, 1}) - Eigen::Vector2d(1, 0)).norm(), 1e-12);
}

TEST(BlendRotations, HalfWay_IsHalfTheTurnHoweverFarItIs) {
  for (const double degrees : {10.0, 90.0, 180.0, 270.0, 350.0, -270.0}) {
    const Turn<3> turn = degrees * kDegree * Turn<3>(1, 2, -1).normalized();
    const Turn<3> half = turn / 2;
    const Eigen::Matrix3d expected =
        Eigen::AngleAxisd(half.norm(), half.normalized()).toRotationMatrix();
    EXPECT_LT((BlendAt(0.5, turn) - expected).norm(), 1e-12) << degrees;
    EXPECT_LT((BlendAt(0, turn) - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    HandleMotion<3> whole;
    whole.turn = turn;
    EXPECT_LT((BlendAt(1, turn) - whole.Rotation()).norm(), 1e-12);
  }
}

TEST(BlendRotations, OppositeWishes_StillGiveARotation) {
  const Eigen::Matrix3d r = BlendAt(0.5, {0, 0, 360 * kDegree});
  EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_GT(r.determinant(), 0);
}

TEST(BlendRotations, InThePlane_AnglesAddUpBeyondAWholeTurn) {
  const TriangleMesh mesh = test::MakeGrid(1);
  Vector<HandleMotion<2>> handles(2);
  handles[1].turn[0] = 500 * kDegree;
  Eigen::MatrixXd weights = Eigen::MatrixXd::Constant(4, 2, 0.5);
  const Eigen::Matrix2d expected = Eigen::Rotation2Dd(250 * kDegree).toRotationMatrix();
  EXPECT_LT((BlendRotations(mesh, handles, weights)[0] - expected).norm(), 1e-12);
}

}  // namespace
}  // namespace limber::deform
