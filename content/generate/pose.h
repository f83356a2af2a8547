// An example shape as limbs posed in a warped space.
#pragma once

#include "generate/curve.h"
#include "generate/space_warp.h"

#include <functional>
#include <utility>
#include <vector>

namespace limber::content {

// How much a limb turns along the way, as for Curve::Turning.
using Turn = std::function<Vector3d(double)>;

// A turn of `angle` radians about `axis`, spread softly around u from `from` to `to`.
Turn Arc(const Vector3d& axis, double angle, double from = 0, double to = 1);
Turn Both(Turn a, Turn b);

// A limb's spine in an example shape: it leaves the body as at rest, then turns its own way.
struct LimbPose {
  double length = 1;     // times its length at rest
  double thickness = 1;  // at its tip, times that at rest
  Turn turn = [](double) { return Vector3d(Vector3d::Zero()); };
};

// Limbs are posed first, then all of space is warped. Past its root a limb keeps its own thickness
// and follows the rigid part of the warp at the root, so that no warp flattens what is far out.
class Pose {
 public:
  explicit Pose(SpaceWarp warp) : warp_(std::move(warp)) {}

  // `limb` must outlive the pose. A mirrored limb is the image of `limb` in the plane x = 0.
  void Add(const Limb& limb, const LimbPose& pose, bool mirrored = false);

  const SpaceWarp& warp() const { return warp_; }

  Vector3d operator()(const Vector3d& p) const;

 private:
  struct PosedLimb {
    const Limb* limb;
    Curve spine;
    double thickness;
    bool mirrored;
    Vector3d root, root_image;
    Eigen::Matrix3d rotation;
  };

  SpaceWarp warp_;
  std::vector<PosedLimb> limbs_;
};

}  // namespace limber::content
