#include "generate/pose.h"

#include "generate/shaping.h"

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
