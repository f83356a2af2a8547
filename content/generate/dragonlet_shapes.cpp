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

// One gesture, its warp by an amount. Right limbs are posed as the mirror images of left ones.
struct DragonletPose {
  std::function<SpaceWarp(double)> warp;
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

// The girth of `swell` at an amount.
std::function<double(double)> Girth(double amount, std::function<double(double)> swell) {
  return [amount, swell = std::move(swell)](double y) { return 1 + amount * (swell(y) - 1); };
}

void Squash(DragonletPose* pose) {
  pose->eye_give = 0.8;
  pose->warp = [](double amount) {
    const auto girth = [](double y) { return 1.28 + 0.22 * (1 - SmoothStep(0, 1.3, y)); };
    return Swell(Mix(1, 0.54, amount), Girth(amount, girth), 1.1);
  };
  const LimbPose arm = {1.2, 1.05, Both(Arc(kZ, 0.3), Arc(kY, -0.2))};
  pose->Arms(arm, arm);
  const LimbPose ear = {1.0, 1.1, Arc(kZ, -0.9)};
  pose->Ears(ear, ear);
  pose->Tail({1.05, 1.1, Both(Arc(kY, -2.0, 0.1, 0.7), Arc(kX, 0.28, 0.0, 0.6))});
}

void Stretch(DragonletPose* pose) {
  pose->eye_give = 0.6;
  pose->warp = [](double amount) {
    const auto girth = [](double y) { return 0.9 - 0.2 * Bump(y, 0.75, 0.4); };
    return Swell(Mix(1, 1.55, amount), Girth(amount, girth), 1.2);
  };
  const LimbPose arm = {1.35, 0.85, Arc(kZ, -1.0, 0.0, 0.8)};
  pose->Arms(arm, arm);
  const LimbPose ear = {1.2, 0.9, Arc(kZ, -1.5, 0.1, 0.9)};
  pose->Ears(ear, ear);
  pose->Tail({1.2, 0.85, Both(Arc(kY, -0.5, 0.1, 0.7), Arc(kX, 0.15, 0.3, 1.0))});
}

void Puff(DragonletPose* pose) {
  pose->warp = [](double amount) {
    return Then(Balloon({0, 0.85, 0}, {1.12, 1.1, 1.05}, 0.9 * amount),
                Shift({0, 0.32 * amount, 0}));
  };
  pose->eye_give = 0.75;
  pose->eye_size = 1.06;
  const LimbPose arm = {0.8, 1.0, Arc(kZ, 0.5)};
  pose->Arms(arm, arm);
  const LimbPose ear = {0.9, 1.1, Arc(kZ, 0.9)};
  pose->Ears(ear, ear);
  pose->Tail({0.8, 1.3, Both(Arc(kY, -1.0, 0.2, 0.9), Arc(kX, 0.5, 0.2, 0.9))});
}

void Curl(DragonletPose* pose) {
  pose->warp = [](double amount) {
    const auto girth = [](double) { return 1.04; };
    return Then(Swell(Mix(1, 0.94, amount), Girth(amount, girth), 1.2),
                BendAboutX(0.28 * amount, 0.2, 1.6));
  };
  const LimbPose arm = {1.0, 1.0, Both(Arc(kY, -1.3), Arc(kZ, 0.3))};
  pose->Arms(arm, arm);
  const LimbPose ear = {0.9, 1.0, Both(Arc(kZ, -1.2), Arc(kY, -0.6))};
  pose->Ears(ear, ear);
  // Along the ground, around the left foot, to the front.
  pose->Tail(
      {1.35, 0.95,
       Both(Both(Arc(kY, -3.6, 0.05, 1.1), Arc(kX, 0.26, 0.0, 0.4)), Arc(kX, -0.8, 0.55, 1.0))});
}

// side: +1 leans to its left, -1 to its right.
void Lean(double side, DragonletPose* pose) {
  pose->warp = [side](double amount) {
    const auto girth = [](double y) { return 0.96 - 0.06 * Bump(y, 0.8, 0.4); };
    return Then(Swell(Mix(1, 1.14, amount), Girth(amount, girth), 1.2),
                BendAboutZ(-0.95 * side * amount, 0.05, 1.9));
  };
  const LimbPose up = {1.3, 0.95, Both(Arc(kZ, 1.3), Arc(kY, 0.3))};
  const LimbPose down = {1.05, 1.0, Arc(kZ, -0.5)};
  pose->Arms(side > 0 ? down : up, side > 0 ? up : down);
  const LimbPose ear_up = {1.1, 1.0, Arc(kZ, 0.9)}, ear_down = {1.0, 1.0, Arc(kZ, -0.8)};
  pose->Ears(side > 0 ? ear_down : ear_up, side > 0 ? ear_up : ear_down);
  pose->Tail(
      {1.1, 1.0,
       Both(Arc(kY, side > 0 ? 0.8 : -1.4, 0.1, 0.7), Arc(kZ, side > 0 ? -0.4 : 0.4, 0.5, 1.0))});
}

void Wave(DragonletPose* pose) {
  pose->warp = [](double amount) { return BendAboutZ(0.26 * amount, 0.1, 1.8); };
  pose->Arms({1.75, 1.3, Both(Arc(kZ, 1.75, 0.1, 0.8), Arc(kZ, -0.8, 0.65, 1.0))},
             {1.1, 1.0, Arc(kZ, -0.5)});
  pose->Ears({1.05, 1.0, Arc(kZ, 1.0)}, {1.0, 1.0, Arc(kZ, -0.3)});
  pose->Tail({1.05, 1.0, Both(Arc(kY, 0.6, 0.1, 0.7), Arc(kZ, -0.6, 0.5, 1.0))});
}

void Startled(DragonletPose* pose) {
  pose->warp = [](double amount) {
    const auto girth = [](double y) { return 0.9 + 0.12 * SmoothStep(0.7, 1.4, y); };
    return Then(Swell(Mix(1, 1.14, amount), Girth(amount, girth), 1.2),
                Shift({0, 0.4 * amount, 0}));
  };
  pose->eye_give = 0.3;
  pose->eye_size = 1.22;
  const LimbPose arm = {1.45, 1.1, Both(Arc(kZ, 1.25), Arc(kY, 0.4))};
  pose->Arms(arm, arm);
  const LimbPose ear = {1.35, 0.9, Arc(kZ, 1.25)};
  pose->Ears(ear, ear);
  pose->Tail({1.15, 1.25, Both(Arc(kX, 2.0, 0.1, 0.6), Arc(kY, -0.5, 0.1, 0.5))});
}

struct Gesture {
  const char* name;
  void (*draw)(DragonletPose*);
};

// In the order in which their warps follow each other where they are mixed: the balloon is blown
// up from the body as it is at rest.
constexpr Gesture kGestures[] = {{"puff", Puff},
                                 {"squash", Squash},
                                 {"stretch", Stretch},
                                 {"curl", Curl},
                                 {"lean_left", [](DragonletPose* pose) { Lean(1, pose); }},
                                 {"lean_right", [](DragonletPose* pose) { Lean(-1, pose); }},
                                 {"wave", Wave},
                                 {"startled", Startled}};

using AmountedPoses = std::vector<std::pair<double, DragonletPose>>;

AmountedPoses PosesOf(const GestureMix& mix) {
  AmountedPoses poses;
  for (const Gesture& gesture : kGestures) {
    const double amount = AmountOf(gesture.name, mix);
    if (amount == 0) continue;
    poses.emplace_back(amount, DragonletPose());
    gesture.draw(&poses.back().second);
  }
  return poses;
}

SpaceWarp MixedWarp(const AmountedPoses& poses) {
  SpaceWarp warp = Shift(Vector3d::Zero());
  for (const auto& [amount, pose] : poses)
    warp = Then(warp, pose.warp(amount));
  return warp;
}

LimbPose MixedLimb(const Limb& limb, const AmountedPoses& poses, LimbPose DragonletPose::*member) {
  std::vector<std::pair<double, LimbPose>> wishes;
  for (const auto& [amount, pose] : poses)
    wishes.emplace_back(amount, pose.*member);
  return Mixed(limb, wishes);
}

}  // namespace

struct DragonletPoser::Posed {
  Pose pose;
  double eye_size, eye_give;
};

std::vector<DragonletShape> DragonletShapes() {
  std::vector<DragonletShape> shapes = {{"rest", {}}};
  for (const char* name :
       {"squash", "stretch", "puff", "curl", "lean_left", "lean_right", "wave", "startled"}) {
    shapes.push_back({name, {{name, 1}}});
  }
  // The tail goes half around the body: on the way it needs an example to keep its roundness.
  shapes.push_back({"curl_half", {{"curl", 0.5}}});
  return shapes;
}

DragonletPoser::DragonletPoser(const DragonletModel& model, const GestureMix& mix) {
  if (mix.empty()) return;
  const AmountedPoses poses = PosesOf(mix);
  double eye_size = 1, eye_give = 1;
  for (const auto& [amount, pose] : poses) {
    eye_size += amount * (pose.eye_size - 1);
    eye_give += amount * (pose.eye_give - 1);
  }
  posed_.reset(new Posed{Pose(MixedWarp(poses)), eye_size, eye_give});
  Pose& pose = posed_->pose;
  pose.Add(model.tail(), MixedLimb(model.tail(), poses, &DragonletPose::tail));
  pose.Add(model.arm(), MixedLimb(model.arm(), poses, &DragonletPose::arm_left));
  pose.Add(model.ear(), MixedLimb(model.ear(), poses, &DragonletPose::ear_left));
  pose.Add(model.arm(), MixedLimb(model.arm(), poses, &DragonletPose::arm_right), true);
  pose.Add(model.ear(), MixedLimb(model.ear(), poses, &DragonletPose::ear_right), true);
}

DragonletPoser::~DragonletPoser() = default;
DragonletPoser::DragonletPoser(DragonletPoser&&) noexcept = default;

Vector3d DragonletPoser::Body(const Vector3d& p) const {
  return posed_ == nullptr ? p : posed_->pose(p);
}

Vector3d DragonletPoser::Eye(const DragonletEye& eye, const Vector3d& p) const {
  if (posed_ == nullptr) return p;
  const SpaceWarp& warp = posed_->pose.warp();
  const Eigen::Matrix3d jacobian = WarpJacobian(warp, eye.centre);
  const Eigen::Matrix3d rotation = NearestRotation(jacobian);
  const Eigen::Matrix3d turn = rotation + posed_->eye_give * (jacobian - rotation);
  return warp(eye.centre) + posed_->eye_size * (turn * (p - eye.centre));
}

}  // namespace limber::content
