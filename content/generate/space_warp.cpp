#include "generate/space_warp.h"

#include "generate/shaping.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <cmath>
#include <utility>

namespace limber::content {
namespace {

// (across, along) of a straight line along y, bent towards negative `across`.
Vector2d Bend(double angle, double from, double to, const Vector2d& p) {
  constexpr int kSteps = 48;
  const double end = std::min(std::max(p.y(), from), to), step = (end - from) / kSteps;
  Vector2d on_axis(0, std::min(p.y(), from));
  for (int i = 0; i < kSteps; ++i) {
    const double turn = angle * SmoothStep(from, to, from + (i + 0.5) * step);
    on_axis += step * Vector2d(-std::sin(turn), std::cos(turn));
  }
  const double turn = angle * SmoothStep(from, to, p.y());
  const double beyond = std::max(p.y() - to, 0.0);
  return on_axis + beyond * Vector2d(-std::sin(turn), std::cos(turn)) +
         p.x() * Vector2d(std::cos(turn), std::sin(turn));
}

}  // namespace

SpaceWarp Then(SpaceWarp first, SpaceWarp second) {
  return [first = std::move(first), second = std::move(second)](const Vector3d& p) {
    return second(first(p));
  };
}

SpaceWarp Swell(double height, std::function<double(double)> girth, double reach) {
  return [height, girth = std::move(girth), reach](const Vector3d& p) {
    const double radius = std::hypot(p.x(), p.z());
    // tanh(x) / x, continued through 0.
    const double t = radius / reach, fade = t > 1e-4 ? std::tanh(t) / t : 1 - t * t / 3;
    const double scale = 1 + (girth(p.y()) - 1) * fade;
    return Vector3d(scale * p.x(), height * p.y(), scale * p.z());
  };
}

SpaceWarp BendAboutZ(double angle, double from, double to) {
  return [=](const Vector3d& p) {
    const Vector2d bent = Bend(angle, from, to, p.head<2>());
    return Vector3d(bent.x(), bent.y(), p.z());
  };
}

SpaceWarp BendAboutX(double angle, double from, double to) {
  return [=](const Vector3d& p) {
    const Vector2d bent = Bend(angle, from, to, {-p.z(), p.y()});
    return Vector3d(p.x(), bent.y(), -bent.x());
  };
}

SpaceWarp Shift(const Vector3d& offset) {
  return [offset](const Vector3d& p) { return Vector3d(p + offset); };
}

Eigen::Matrix3d WarpJacobian(const SpaceWarp& warp, const Vector3d& p) {
  constexpr double kStep = 1e-4;
  Eigen::Matrix3d jacobian;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d d = kStep * Vector3d::Unit(axis);
    jacobian.col(axis) = (warp(p + d) - warp(p - d)) / (2 * kStep);
  }
  return jacobian;
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace limber::content
