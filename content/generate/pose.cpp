#include "generate/pose.h"

#include "generate/shaping.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace limber::content {
namespace {

Vector3d Mirror(const Vector3d& p, bool mirrored) {
  return mirrored ? Vector3d(-p.x(), p.y(), p.z()) : p;
}

}  // namespace

Turn Arc(const Vector3d& axis, double angle, double from, double to) {
  const double width = (to - from) / 3, height = angle / (width * std::sqrt(std::numbers::pi));
  return [=](double u) { return Vector3d(axis * (height * Bump(u, (from + to) / 2, width))); };
}

Turn Both(Turn a, Turn b) {
  return [a = std::move(a), b = std::move(b)](double u) { return Vector3d(a(u) + b(u)); };
}

Turn RestTurn(const Limb& limb) {
  const Curve* spine = &limb.spine;
  return [spine](double u) {
    const double a = std::max(u - 0.01, 0.0), b = std::min(u + 0.01, 1.0);
    const Vector3d from = spine->Frame(a).col(2), to = spine->Frame(b).col(2);
    const Vector3d axis = from.cross(to);
    const double sine = axis.norm();
    if (sine < 1e-12) return Vector3d(Vector3d::Zero());
    return Vector3d(axis * (std::atan2(sine, from.dot(to)) / (sine * (b - a))));
  };
}

double SmoothingAt(const Vector3d& p, const std::vector<const Limb*>& limbs) {
  double share = 0;
  for (const Limb* limb : limbs)
    share = std::max(share, limb->Share(p, 1.5 * limb->root));
  return 1 - share;
}

double AmountOf(const std::string& gesture, const GestureMix& mix) {
  double amount = 0;
  for (const GestureAmount& part : mix)
    amount += part.gesture == gesture ? part.amount : 0;
  return amount;
}

LimbPose Mixed(const Limb& limb, const std::vector<std::pair<double, LimbPose>>& poses) {
  const Turn rest = RestTurn(limb);
  LimbPose mixed;
  for (const auto& [amount, pose] : poses) {
    mixed.length += amount * (pose.length - 1);
    mixed.thickness += amount * (pose.thickness - 1);
  }
  mixed.turn = [rest, poses](double u) {
    const Vector3d at_rest = rest(u);
    Vector3d turn = at_rest;
    for (const auto& [amount, pose] : poses)
      turn += amount * (pose.turn(u) - at_rest);
    return turn;
  };
  return mixed;
}

void Pose::Add(const Limb& limb, const LimbPose& pose, bool mirrored) {
  const Vector3d root = Mirror(limb.spine.Point(0.7 * limb.root), mirrored);
  limbs_.push_back({&limb,
                    Curve::Turning(limb.spine.Point(0), limb.spine.Frame(0).col(2),
                                   pose.length * limb.spine.Length(), pose.turn),
                    pose.thickness, mirrored, root, warp_(root),
                    NearestRotation(WarpJacobian(warp_, root))});
}

Vector3d Pose::operator()(const Vector3d& p) const {
  const Vector3d bare = warp_(p);
  Vector3d moved = bare;
  for (const PosedLimb& limb : limbs_) {
    const Vector3d here = Mirror(p, limb.mirrored);
    if (limb.limb->Share(here, limb.limb->root) == 0) continue;
    const auto thickness = [&](double u) {
      return Mix(1, limb.thickness, SmoothStep(0.1, 0.9, u));
    };
    const Vector3d posed =
        Mirror(MoveWithLimb(*limb.limb, limb.spine, thickness, here), limb.mirrored);
    const Vector3d rigid = limb.root_image + limb.rotation * (posed - limb.root);
    const Vector3d warped = warp_(posed);
    const double share = limb.limb->Share(here, 1.3 * limb.limb->root);
    moved += warped + share * (rigid - warped) - bare;
  }
  return moved;
}

}  // namespace limber::content
