#include "bake/rig_space.h"

#include "core/vector.h"
#include "editor_tools/geometry/solve_meshes.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>

namespace limber::bake {
namespace {

using geometry::PointMatrix;

Eigen::Matrix3d Basis(const RigSpace& space) {
  return Eigen::Map<const Eigen::Matrix3f>(space.basis.data()).cast<double>();
}

// Mesh space to rig space, rows are points.
PointMatrix ToRig(const RigSpace& space, const PointMatrix& points) {
  const Eigen::RowVector3d origin(space.origin[0], space.origin[1], space.origin[2]);
  return (points.rowwise() - origin) * Basis(space) / space.scale;
}

PointMatrix ToMesh(const RigSpace& space, const PointMatrix& points) {
  const Eigen::RowVector3d origin(space.origin[0], space.origin[1], space.origin[2]);
  return (points * Basis(space).transpose() * space.scale).rowwise() + origin;
}

Vector<PointMatrix> PlanarShapes() {
  const PointMatrix rest = test::MakeGrid(6, 3).shapes[0];
  return {rest, rest * Eigen::Vector3d(2, 0.7, 1).asDiagonal()};
}

Vector<PointMatrix> Mapped(Vector<PointMatrix> shapes, const Eigen::Matrix3d& linear,
                           const Eigen::RowVector3d& offset) {
  for (PointMatrix& shape : shapes) {
    shape = ((shape * linear.transpose()).rowwise() + offset).eval();
  }
  return shapes;
}

double DiagonalOf(const PointMatrix& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

TEST(FitRigSpace, Solid_KeepsItsAxesAndIsOneLarge) {
  const PointMatrix blob = test::MakeBlob(10, 8).shapes[0];
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const Vector<PointMatrix> shapes =
        Mapped({blob, 1.5 * blob}, scale * Eigen::Matrix3d::Identity(),
               scale * Eigen::RowVector3d(3, 1, 2));
    int dimension = 0;
    const RigSpace space = FitRigSpace(shapes, &dimension);
    EXPECT_EQ(dimension, 3);
    EXPECT_EQ(Basis(space), Eigen::Matrix3d::Identity());
    EXPECT_NEAR(DiagonalOf(ToRig(space, shapes[0])), 1, 1e-6);
    const PointMatrix larger = ToRig(space, shapes[1]);  // the box of both together
    EXPECT_LT(larger.colwise().maxCoeff().cwiseAbs().maxCoeff(), 2);
  }
}

TEST(FitRigSpace, XyDrawing_GetsTheIdentity) {
  int dimension = 0;
  const RigSpace space = FitRigSpace(PlanarShapes(), &dimension);
  EXPECT_EQ(dimension, 2);
  EXPECT_EQ(Basis(space), Eigen::Matrix3d::Identity());
  EXPECT_EQ(space.origin, (std::array<float, 3>{6, 1.5, 0}));
}

TEST(FitRigSpace, TiltedPlane_LiesInXyAndComesBack) {
  for (int i = 0; i < 12; ++i) {
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(0.6 * i, Eigen::Vector3d(std::sin(i), 1, std::cos(2.0 * i)).normalized())
            .toRotationMatrix();
    const Vector<PointMatrix> shapes = Mapped(PlanarShapes(), rotation, {5, -3, 8});
    int dimension = 0;
    const RigSpace space = FitRigSpace(shapes, &dimension);
    ASSERT_EQ(dimension, 2);
    EXPECT_NEAR(Basis(space).determinant(), 1, 1e-6);
    EXPECT_LT((Basis(space).transpose() * Basis(space) - Eigen::Matrix3d::Identity())
                  .lpNorm<Eigen::Infinity>(),
              1e-6);
    for (const PointMatrix& shape : shapes) {
      const PointMatrix rig = ToRig(space, shape);
      EXPECT_LT(rig.col(2).lpNorm<Eigen::Infinity>(), 1e-6);
      EXPECT_LT((ToMesh(space, rig) - shape).lpNorm<Eigen::Infinity>(), 1e-5);
    }
  }
}

TEST(FitRigSpace, AxisPlanes_UseTheMeshsOwnAxes) {
  Eigen::Matrix3d to_xz, to_yz;
  to_xz << 1, 0, 0, 0, 0, 1, 0, 1, 0;
  to_yz << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  for (const Eigen::Matrix3d& map : {to_xz, to_yz}) {
    int dimension = 0;
    const RigSpace space = FitRigSpace(Mapped(PlanarShapes(), map, {0, 0, 0}), &dimension);
    EXPECT_EQ(dimension, 2);
    EXPECT_NEAR(Basis(space).determinant(), 1, 1e-12);
    EXPECT_EQ(Basis(space).cwiseAbs().colwise().sum(), Eigen::RowVector3d::Ones());
    EXPECT_EQ(Basis(space).cwiseAbs().colwise().maxCoeff(), Eigen::RowVector3d::Ones());
  }
}

TEST(FitRigSpace, OneShapeOrOneVertexOutOfThePlane_IsSolid) {
  int dimension = 0;
  Vector<PointMatrix> shapes = PlanarShapes();
  shapes[1].col(2).setConstant(0.01);  // planar, but in another plane
  FitRigSpace(shapes, &dimension);
  EXPECT_EQ(dimension, 3);
  shapes = PlanarShapes();
  shapes[1](5, 2) = 1e-4;
  FitRigSpace(shapes, &dimension);
  EXPECT_EQ(dimension, 3);
  shapes[1](5, 2) = 1e-7;
  FitRigSpace(shapes, &dimension);
  EXPECT_EQ(dimension, 2);
}

TEST(FitRigSpace, CollapsedShapes_GiveFiniteNumbers) {
  int dimension = 0;
  const Vector<PointMatrix> point = {PointMatrix::Constant(4, 3, 2)};
  const RigSpace space = FitRigSpace(point, &dimension);
  EXPECT_GT(space.scale, 0);
  EXPECT_TRUE(Basis(space).allFinite());
  PointMatrix line = PointMatrix::Zero(4, 3);
  line.col(1) << 0, 1, 2, 3;
  const RigSpace of_line = FitRigSpace(std::span(&line, 1), &dimension);
  EXPECT_EQ(dimension, 2);
  EXPECT_NEAR(Basis(of_line).determinant(), 1, 1e-6);
}

}  // namespace
}  // namespace limber::bake
