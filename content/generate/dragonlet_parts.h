// What the dragonlet is made of; shared by the files that model, paint and pose it.
#pragma once

#include "generate/canvas.h"
#include "generate/character.h"
#include "generate/curve.h"
#include "generate/pose.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace limber::content {

enum class DragonletPart { kCore, kSnout, kFoot, kArm, kEar, kHorn, kRidge, kTail };
constexpr int kNumDragonletParts = 8;

// An eye: an ellipsoid about `centre`, its axes the columns of `axes` (the last looks ahead).
struct DragonletEye {
  Vector3d centre;
  Eigen::Matrix3d axes;
  Vector3d radii;

  // `p` in the frame in which the eye is the unit sphere.
  Vector3d Local(const Vector3d& p) const;
};

class DragonletModel {
 public:
  DragonletModel();

  // Signed distances (approximate) from each part, and from all of them melted together.
  std::array<double, kNumDragonletParts> PartDistances(const Vector3d& p) const;
  double Distance(const Vector3d& p) const;
  // Head and trunk without anything that sticks out: what balloons when the dragonlet puffs.
  static double CoreDistance(const Vector3d& p);
  DragonletPart NearestPart(const Vector3d& p) const;

  const Limb& tail() const { return tail_; }

  // The left ones (x > 0); the right ones are their mirror images.
  const Limb& arm() const { return arm_; }

  const Limb& ear() const { return ear_; }

  DragonletEye Eye(bool left) const;

 private:
  Limb tail_, arm_, ear_;
};

inline Vector3d Mirrored(const Vector3d& p) {
  return {-p.x(), p.y(), p.z()};
}

// The colour of the skin at a point of the rest surface.
Colour DragonletSkin(const DragonletModel& model, const Vector3d& p);
// The colour of an eye in direction `d` (unit, the eye's own frame: x its left, y up, z ahead).
Colour DragonletEyeColour(const Vector3d& d);

// An example shape: a mix of gestures. [0] is rest.
struct DragonletShape {
  std::string name;
  GestureMix mix;
};

std::vector<DragonletShape> DragonletShapes();

// Where a mix of gestures takes the rest point `p` of the body, or of an eye; the empty mix moves
// nothing at all.
class DragonletPoser {
 public:
  DragonletPoser(const DragonletModel& model, const GestureMix& mix);
  ~DragonletPoser();
  DragonletPoser(DragonletPoser&&) noexcept;

  Vector3d Body(const Vector3d& p) const;
  Vector3d Eye(const DragonletEye& eye, const Vector3d& p) const;

 private:
  struct Posed;
  std::unique_ptr<Posed> posed_;  // none at rest
};

}  // namespace limber::content
