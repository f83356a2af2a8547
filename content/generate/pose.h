// An example shape as limbs posed in a warped space.
#pragma once

#include "generate/curve.h"
#include "generate/space_warp.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace limber::content {

// How much a limb turns along the way, as for Curve::Turning.
using Turn = std::function<Vector3d(double)>;

// How a limb's spine turns at rest.
Turn RestTurn(const Limb& limb);
// A turn of `angle` radians about `axis`, spread softly around u from `from` to `to`.
Turn Arc(const Vector3d& axis, double angle, double from = 0, double to = 1);
Turn Both(Turn a, Turn b);

// A limb's spine in an example shape: it leaves the body as at rest, then turns its own way.
struct LimbPose {
  double length = 1;     // times its length at rest
  double thickness = 1;  // at its tip, times that at rest
  Turn turn = [](double) { return Vector3d(Vector3d::Zero()); };
};

// How much the offsets of `p` are to be smoothed: fully on the body and about the limbs' roots, not
// at all out on the limbs. There a turn makes offsets vary linearly, and smoothing them would
// crush the tip.
double SmoothingAt(const Vector3d& p, const std::vector<const Limb*>& limbs);

// A gesture at some amount: 0 is rest, 1 the gesture as drawn; a little beyond either is fine.
struct GestureAmount {
  std::string gesture;
  double amount = 1;
};

// Several at once; a gesture that is not named has the amount 0.
using GestureMix = std::vector<GestureAmount>;

double AmountOf(const std::string& gesture, const GestureMix& mix);

// The pose of `limb` that is, for each (amount, pose), that much of the way from rest: lengths,
// thicknesses and turns add up, so that a limb swings on an arc and never shortens on its way.
LimbPose Mixed(const Limb& limb, const std::vector<std::pair<double, LimbPose>>& poses);

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
