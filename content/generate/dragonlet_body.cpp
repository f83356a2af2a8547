#include "generate/dragonlet_parts.h"
#include "generate/shaping.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <utility>

namespace limber::content {
namespace {

double Ellipsoid(const Vector3d& p, const Vector3d& centre, const Vector3d& radii) {
  const Vector3d q = p - centre;
  const double k0 = q.cwiseQuotient(radii).norm();
  const double k1 = q.cwiseQuotient(radii.cwiseAbs2()).norm();
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -radii.minCoeff();
}

double TaperedRod(const Vector3d& p, const Vector3d& a, const Vector3d& b, double radius_a,
                  double radius_b) {
  const Vector3d along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm() - Mix(radius_a, radius_b, t);
}

Limb MakeTail() {
  const auto turn = [](double u) {
    return Vector3d(0, -2.9 * SmoothStep(0.05, 0.4, u) * (1 - SmoothStep(0.55, 1, u)),
                    3.2 * SmoothStep(0.42, 0.8, u));
  };
  const auto radius = [](double u) {
    return Mix(0.27, 0.09, std::pow(u, 0.75)) + 0.085 * Bump(u, 0.9, 0.09);
  };
  return {Curve::Turning({0, 0.4, -0.18}, {0.0, -0.22, -1}, 1.95, turn), radius, 0.3};
}

Limb MakeArm() {
  const auto turn = [](double) { return Vector3d(0, -0.5, -0.45); };
  const auto radius = [](double u) { return 0.1 + 0.035 * SmoothStep(0.45, 1, u); };
  Limb arm{Curve::Turning({0.22, 0.78, 0.08}, {1, -0.1, 0.25}, 0.54, turn), radius, 0.7};
  // The trunk is close below: it must not be dragged along when the arm goes up.
  arm.near = 1.2;
  arm.far = 2.0;
  return arm;
}

Limb MakeEar() {
  const auto turn = [](double) { return Vector3d(0, 0, 0.5); };
  // A leaf: slim at the root, full in the middle, pointed at the tip.
  const auto radius = [](double u) { return 0.07 + 0.085 * Bump(u, 0.55, 0.33); };
  return {Curve::Turning({0.36, 1.42, -0.08}, {1, 0.34, -0.2}, 0.72, turn), radius, 0.45};
}

}  // namespace

Vector3d DragonletEye::Local(const Vector3d& p) const {
  return (axes.transpose() * (p - centre)).cwiseQuotient(radii);
}

DragonletModel::DragonletModel() : tail_(MakeTail()), arm_(MakeArm()), ear_(MakeEar()) {}

double DragonletModel::CoreDistance(const Vector3d& p) {
  const double cranium = Ellipsoid(p, {0, 1.3, -0.02}, {0.56, 0.48, 0.5});
  const double cheeks = Ellipsoid(p, {0, 1.1, 0.04}, {0.62, 0.34, 0.47});
  const double chest = Ellipsoid(p, {0, 0.68, -0.02}, {0.36, 0.4, 0.34});
  const double belly = Ellipsoid(p, {0, 0.42, 0}, {0.47, 0.42, 0.43});
  return SmoothMin(SmoothMin(cranium, cheeks, 0.3), SmoothMin(chest, belly, 0.25), 0.2);
}

std::array<double, kNumDragonletParts> DragonletModel::PartDistances(const Vector3d& p) const {
  const Vector3d q(std::abs(p.x()), p.y(), p.z());
  std::array<double, kNumDragonletParts> d{};
  const auto set = [&d](DragonletPart part, double value) { d[static_cast<int>(part)] = value; };
  set(DragonletPart::kCore, CoreDistance(p));
  set(DragonletPart::kSnout, Ellipsoid(p, {0, 1.04, 0.42}, {0.25, 0.17, 0.22}));
  const double sole = Ellipsoid(q, {0.27, 0.14, 0.17}, {0.18, 0.14, 0.27});
  const double ankle = Ellipsoid(q, {0.27, 0.24, 0.04}, {0.18, 0.22, 0.2});
  set(DragonletPart::kFoot, SmoothMin(sole, ankle, 0.12));
  set(DragonletPart::kArm, arm_.Distance(q));
  // Ears are flat: measured in a space that is stretched front to back.
  Vector3d flat = q;
  flat.z() = ear_.spine.Point(0.4).z() + (q.z() - ear_.spine.Point(0.4).z()) * 1.5;
  set(DragonletPart::kEar, ear_.Distance(flat) / 1.25);
  set(DragonletPart::kHorn, TaperedRod(q, {0.2, 1.66, 0.06}, {0.25, 1.92, -0.02}, 0.09, 0.055));
  double ridge = 1e9;
  constexpr double kRidges[5][3] = {{1.77, -0.12, 0.085},
                                    {1.55, -0.42, 0.1},
                                    {1.22, -0.5, 0.095},
                                    {0.9, -0.36, 0.09},
                                    {0.62, -0.41, 0.08}};
  for (const auto& [y, z, radius] : kRidges) {
    ridge = std::min(ridge, Ellipsoid(p, {0, y, z}, {0.6 * radius, radius, radius}));
  }
  set(DragonletPart::kRidge, ridge);
  set(DragonletPart::kTail, tail_.Distance(p));
  return d;
}

double DragonletModel::Distance(const Vector3d& p) const {
  constexpr double kMelt[kNumDragonletParts] = {0, 0.16, 0.12, 0.12, 0.12, 0.12, 0.09, 0.22};
  const auto d = PartDistances(p);
  double distance = d[0];
  for (int part = 1; part < kNumDragonletParts; ++part) {
    distance = SmoothMin(distance, d[part], kMelt[part]);
  }
  return distance;
}

DragonletPart DragonletModel::NearestPart(const Vector3d& p) const {
  const auto d = PartDistances(p);
  return static_cast<DragonletPart>(std::min_element(d.begin(), d.end()) - d.begin());
}

DragonletEye DragonletModel::Eye(bool left) const {
  const double side = left ? 1 : -1;
  DragonletEye eye;
  eye.centre = {side * 0.275, 1.29, 0.345};
  eye.axes = (Eigen::AngleAxisd(side * 0.36, Vector3d::UnitY()) *
              Eigen::AngleAxisd(-0.06, Vector3d::UnitX()))
                 .toRotationMatrix();
  eye.radii = {0.185, 0.23, 0.16};
  return eye;
}

}  // namespace limber::content
