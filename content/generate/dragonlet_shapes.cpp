#include "generate/dragonlet_parts.h"
#include "generate/pose.h"
#include "generate/shaping.h"
#include "generate/space_warp.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace limber::content {
namespace {

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();

// One example shape. Right limbs are posed as the mirror images of left ones.
struct DragonletPose {
  SpaceWarp warp = Shift(Vector3d::Zero());
  LimbPose tail, arm_left, arm_right, ear_left, ear_right;
  double eye_size = 1;
  double eye_give = 1;  // 0: the eyes stay round; 1: they take the body's stretch

  void Tail(const LimbPose& pose) { tail = pose; }

  void Arms(const LimbPose& left, const LimbPose& right) {
    arm_left = left;
    arm_right = right;
  }

  void Ears(const LimbPose& left, const LimbPose& right) {
    ear_left = left;
    ear_right = right;
  }
};

// Blown up towards a ball about `centre`; what sticks out of the body is pushed outwards with it.
SpaceWarp Balloon(const Vector3d& centre, const Vector3d& radii, double share) {
  return [=](const Vector3d& p) {
    const Vector3d from = p - centre;
    const double r = from.norm();
    if (r < 1e-9) return p;
    const Vector3d direction = from / r;
    double low = 0.05, high = 2.5;
    // The body's own surface in this direction; it is star-shaped about `centre`.
    for (int i = 0; i < 40; ++i) {
      const double middle = (low + high) / 2;
      (DragonletModel::CoreDistance(centre + middle * direction) < 0 ? low : high) = middle;
    }
    const double ball = 1 / direction.cwiseQuotient(radii).norm();
    const double target = Mix(low, ball, share);
    const double moved = r < low ? r * target / low : r + target - low;
    return Vector3d(centre + moved * direction);
  };
}

void Squash(DragonletPose* pose) {
  pose->eye_give = 0.8;
  pose->warp = Swell(
      0.54, [](double y) { return 1.28 + 0.22 * (1 - SmoothStep(0, 1.3, y)); }, 1.1);
  const LimbPose arm = {1.2, 1.05, Both(Arc(kZ, 0.3), Arc(kY, -0.2))};
  pose->Arms(arm, arm);
  const LimbPose ear = {1.0, 1.1, Arc(kZ, -0.9)};
  pose->Ears(ear, ear);
  pose->Tail({1.05, 1.1, Both(Arc(kY, -2.0, 0.1, 0.7), Arc(kX, 0.28, 0.0, 0.6))});
}

void Stretch(DragonletPose* pose) {
  pose->eye_give = 0.6;
  pose->warp = Swell(
      1.55, [](double y) { return 0.9 - 0.2 * Bump(y, 0.75, 0.4); }, 1.2);
  const LimbPose arm = {1.35, 0.85, Arc(kZ, -1.0, 0.0, 0.8)};
  pose->Arms(arm, arm);
  const LimbPose ear = {1.2, 0.9, Arc(kZ, -1.5, 0.1, 0.9)};
  pose->Ears(ear, ear);
  pose->Tail({1.2, 0.85, Both(Arc(kY, -0.5, 0.1, 0.7), Arc(kX, 0.15, 0.3, 1.0))});
}

void Puff(DragonletPose* pose) {
  pose->warp = Then(Balloon({0, 0.85, 0}, {1.12, 1.1, 1.05}, 0.9), Shift({0, 0.32, 0}));
  pose->eye_give = 0.75;
  pose->eye_size = 1.06;
  const LimbPose arm = {0.8, 1.0, Arc(kZ, 0.5)};
  pose->Arms(arm, arm);
  const LimbPose ear = {0.9, 1.1, Arc(kZ, 0.9)};
  pose->Ears(ear, ear);
  pose->Tail({0.8, 1.3, Both(Arc(kY, -1.0, 0.2, 0.9), Arc(kX, 0.5, 0.2, 0.9))});
}

void Curl(DragonletPose* pose) {
  pose->warp = Then(Swell(
                        0.94, [](double) { return 1.04; }, 1.2),
                    BendAboutX(0.28, 0.2, 1.6));
  const LimbPose arm = {1.0, 1.0, Both(Arc(kY, -1.3), Arc(kZ, 0.3))};
  pose->Arms(arm, arm);
  const LimbPose ear = {0.9, 1.0, Both(Arc(kZ, -1.2), Arc(kY, -0.6))};
  pose->Ears(ear, ear);
  pose->Tail({1.45, 0.9, [](double u) {
                return Vector3d(0, -2.4 * Bump(u, 0.22, 0.12) / 0.2127,
                                (2.2 + 8.5 * u) * SmoothStep(0.25, 0.5, u));
              }});
}

// side: +1 leans to its left, -1 to its right.
void Lean(double side, DragonletPose* pose) {
  pose->warp = Then(Swell(
                        1.14, [](double y) { return 0.96 - 0.06 * Bump(y, 0.8, 0.4); }, 1.2),
                    BendAboutZ(-0.95 * side, 0.05, 1.9));
  const LimbPose up = {1.3, 0.95, Both(Arc(kZ, 1.3), Arc(kY, 0.3))};
  const LimbPose down = {1.05, 1.0, Arc(kZ, -0.5)};
  pose->Arms(side > 0 ? down : up, side > 0 ? up : down);
  const LimbPose ear_up = {1.1, 1.0, Arc(kZ, 0.9)}, ear_down = {1.0, 1.0, Arc(kZ, -0.8)};
  pose->Ears(side > 0 ? ear_down : ear_up, side > 0 ? ear_up : ear_down);
  pose->Tail(
      {1.1, 1.0,
       Both(Arc(kY, side > 0 ? 1.7 : -2.3, 0.1, 0.7), Arc(kZ, side > 0 ? -0.9 : 0.5, 0.5, 1.0))});
}

void Wave(DragonletPose* pose) {
  pose->warp = BendAboutZ(0.26, 0.1, 1.8);
  pose->Arms({1.75, 1.3, Both(Arc(kZ, 1.75, 0.1, 0.8), Arc(kZ, -0.8, 0.65, 1.0))},
             {1.1, 1.0, Arc(kZ, -0.5)});
  pose->Ears({1.05, 1.0, Arc(kZ, 1.0)}, {1.0, 1.0, Arc(kZ, -0.3)});
  pose->Tail({1.05, 1.0, Both(Arc(kY, 2.4, 0.1, 0.7), Arc(kZ, -2.2, 0.5, 1.0))});
}

void Startled(DragonletPose* pose) {
  pose->warp = Then(Swell(
                        1.14, [](double y) { return 0.9 + 0.12 * SmoothStep(0.7, 1.4, y); }, 1.2),
                    Shift({0, 0.4, 0}));
  pose->eye_give = 0.3;
  pose->eye_size = 1.22;
  const LimbPose arm = {1.45, 1.1, Both(Arc(kZ, 1.25), Arc(kY, 0.4))};
  pose->Arms(arm, arm);
  const LimbPose ear = {1.35, 0.9, Arc(kZ, 1.25)};
  pose->Ears(ear, ear);
  pose->Tail({1.15, 1.25, Both(Arc(kX, 2.0, 0.1, 0.6), Arc(kY, -0.5, 0.1, 0.5))});
}

DragonletPose MakePose(const std::string& name) {
  DragonletPose pose;
  if (name == "squash") Squash(&pose);
  if (name == "stretch") Stretch(&pose);
  if (name == "puff") Puff(&pose);
  if (name == "curl") Curl(&pose);
  if (name == "lean_left") Lean(1, &pose);
  if (name == "lean_right") Lean(-1, &pose);
  if (name == "wave") Wave(&pose);
  if (name == "startled") Startled(&pose);
  return pose;
}

}  // namespace

struct DragonletPoser::Shape {
  Pose pose;
  double eye_size, eye_give;
};

std::string DragonletShapeName(int shape) {
  static constexpr const char* kNames[kNumDragonletShapes] = {
      "rest", "squash", "stretch", "puff", "curl", "lean_left", "lean_right", "wave", "startled"};
  return kNames[shape];
}

DragonletPoser::DragonletPoser(const DragonletModel& model, int shape) {
  if (shape == 0) return;
  const DragonletPose wish = MakePose(DragonletShapeName(shape));
  Pose pose(wish.warp);
  pose.Add(model.tail(), wish.tail);
  pose.Add(model.arm(), wish.arm_left);
  pose.Add(model.ear(), wish.ear_left);
  pose.Add(model.arm(), wish.arm_right, true);
  pose.Add(model.ear(), wish.ear_right, true);
  shape_.reset(new Shape{std::move(pose), wish.eye_size, wish.eye_give});
}

DragonletPoser::~DragonletPoser() = default;
DragonletPoser::DragonletPoser(DragonletPoser&&) noexcept = default;

Vector3d DragonletPoser::Body(const Vector3d& p) const {
  return shape_ == nullptr ? p : shape_->pose(p);
}

Vector3d DragonletPoser::Eye(const DragonletEye& eye, const Vector3d& p) const {
  if (shape_ == nullptr) return p;
  const SpaceWarp& warp = shape_->pose.warp();
  const Eigen::Matrix3d jacobian = WarpJacobian(warp, eye.centre);
  const Eigen::Matrix3d rotation = NearestRotation(jacobian);
  const Eigen::Matrix3d turn = rotation + shape_->eye_give * (jacobian - rotation);
  return warp(eye.centre) + shape_->eye_size * (turn * (p - eye.centre));
}

}  // namespace limber::content
