#include "bake/rig_space.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace limber::bake {
namespace {

using geometry::PointMatrix;

constexpr double kPlanarTolerance = 1e-6;  // of the size

struct Box {
  Eigen::Vector3d low, high;

  Eigen::Vector3d centre() const { return 0.5 * (low + high); }

  double diagonal() const { return (high - low).norm(); }
};

Box BoundingBox(std::span<const PointMatrix> shapes) {
  Box box{shapes[0].row(0).transpose(), shapes[0].row(0).transpose()};
  for (const PointMatrix& shape : shapes) {
    box.low = box.low.cwiseMin(shape.colwise().minCoeff().transpose());
    box.high = box.high.cwiseMax(shape.colwise().maxCoeff().transpose());
  }
  return box;
}

double LargestDistanceFromPlane(std::span<const PointMatrix> shapes, const Eigen::Vector3d& centre,
                                const Eigen::Vector3d& normal) {
  double largest = 0;
  for (const PointMatrix& shape : shapes) {
    largest = std::max(largest,
                       ((shape.rowwise() - centre.transpose()) * normal).lpNorm<Eigen::Infinity>());
  }
  return largest;
}

struct Plane {
  Eigen::Vector3d centre, normal;
};

// The plane of least squares through all the shapes' points.
Plane FitPlane(std::span<const PointMatrix> shapes) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (const PointMatrix& shape : shapes) {
    mean += shape.colwise().sum().transpose();
    count += static_cast<double>(shape.rows());
  }
  mean /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PointMatrix& shape : shapes) {
    const PointMatrix centred = shape.rowwise() - mean.transpose();
    covariance += centred.transpose() * centred;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return {mean, solver.eigenvectors().col(0)};
}

// A right-handed basis whose third column is the normal up to its sign. Signs and in-plane axes are
// those nearest to the mesh's own: of the in-plane axes, the first is the projection of the mesh
// axis that lies most nearly in the plane (x before y before z).
Eigen::Matrix3d PlaneBasis(Eigen::Vector3d normal) {
  int dominant = 0;
  normal.cwiseAbs().maxCoeff(&dominant);
  if (normal(dominant) < 0) normal = -normal;
  // A plane that is an axis plane up to rounding is that plane.
  if ((normal - Eigen::Vector3d::Unit(dominant)).norm() < kPlanarTolerance) {
    normal = Eigen::Vector3d::Unit(dominant);
  }
  int first = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(normal(axis)) < std::abs(normal(first)) - 1e-9) first = axis;
  }
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(first);
  Eigen::Matrix3d basis;
  basis.col(0) = (unit - normal * normal.dot(unit)).normalized();
  basis.col(1) = normal.cross(basis.col(0));
  basis.col(2) = normal;
  return basis;
}

}  // namespace

RigSpace FitRigSpace(std::span<const PointMatrix> shapes, int* dimension) {
  RigSpace space;
  *dimension = 3;
  if (shapes.empty() || shapes[0].rows() == 0) return space;
  const Box box = BoundingBox(shapes);
  double size = BoundingBox(shapes.first(1)).diagonal();
  if (!(size > 0)) size = box.diagonal();  // a base shape that is collapsed to a point
  if (!(size > 0)) size = 1;

  Eigen::Vector3d origin = box.centre();
  const Plane plane = FitPlane(shapes);
  if (LargestDistanceFromPlane(shapes, plane.centre, plane.normal) <= kPlanarTolerance * size) {
    *dimension = 2;
    const Eigen::Matrix3d basis = PlaneBasis(plane.normal);
    // The box of a tilted plane has its middle beside the plane in general: back onto it.
    const Eigen::Vector3d normal = basis.col(2);
    origin -= normal * normal.dot(origin - plane.centre);
    Eigen::Map<Eigen::Matrix3f>(space.basis.data()) = basis.cast<float>();
  }
  for (int axis = 0; axis < 3; ++axis)
    space.origin[axis] = static_cast<float>(origin(axis));
  space.scale = static_cast<float>(size);
  return space;
}

}  // namespace limber::bake
