// Curves with a thickness: the spines of tails, arms and ears, and the space around them.
#pragma once

#include "generate/character.h"

#include <functional>
#include <vector>

namespace limber::content {

// A polyline dense enough to pass for a curve, with one frame a point that never twists (parallel
// transport), so that what lies around the curve can be carried over to another pose of it.
class Curve {
 public:
  struct Foot {
    double u = 0;         // parameter in [0, 1] of the nearest point of the curve
    double distance = 0;  // from that point
  };

  // A cubic Bézier curve of four control points.
  static Curve Bezier(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d);
  // The curve that starts at `start` with direction `direction` and turns by `turn(u)` (radians
  // per unit of u, an axis times an angle) while it runs `length`.
  static Curve Turning(const Vector3d& start, const Vector3d& direction, double length,
                       const std::function<Vector3d(double)>& turn);

  Foot Nearest(const Vector3d& p) const;
  Vector3d Point(double u) const;
  // Columns: two directions across, then the tangent; a rotation.
  Eigen::Matrix3d Frame(double u) const;
  double Length() const;

  // A lower bound of the distance from the curve, quickly.
  double Beyond(const Vector3d& p) const { return (p - middle_).norm() - reach_; }

 private:
  explicit Curve(std::vector<Vector3d> points);
  std::vector<Vector3d> points_;
  std::vector<Eigen::Matrix3d> frames_;
  Vector3d middle_ = Vector3d::Zero();  // of a ball around all points, with radius reach_
  double reach_ = 0;
};

// One limb: its spine at rest and its radius along it.
struct Limb {
  Curve spine;
  std::function<double(double)> radius;  // of u in [0, 1]
  double root = 0.3;                     // the limb leaves the body by this u: free from here on
  // What moves with the limb: all within `near` radii of its spine, nothing beyond `far`.
  double near = 1.5, far = 2.4;
  double margin = 0;  // added to the radius for that

  // Exact near the limb; a lower bound of at least 0.4 far from it.
  double Distance(const Vector3d& p) const;
  // How far `p` belongs to the limb and not to the body: 0 on the body and up to a
  // third of u = `full`, 1 from there on, smooth between.
  double Share(const Vector3d& p, double full) const;
};

// Where `p` goes when the limb's spine takes the pose `posed` and swells by `thickness(u)`. Points
// that belong to the body stay: the motion fades in from the limb's root, and with the distance.
Vector3d MoveWithLimb(const Limb& limb, const Curve& posed,
                      const std::function<double(double)>& thickness, const Vector3d& p);

}  // namespace limber::content
