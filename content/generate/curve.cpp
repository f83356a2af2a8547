#include "generate/curve.h"

#include "generate/shaping.h"

#include <Eigen/Geometry>

#include <limits>
#include <utility>

namespace limber::content {
namespace {

constexpr int kNumSegments = 64;
constexpr double kThickest = 0.35;  // no limb's radius is larger

}  // namespace

Curve::Curve(std::vector<Vector3d> points) : points_(std::move(points)) {
  const size_t count = points_.size();
  frames_.resize(count);
  Vector3d tangent = (points_[1] - points_[0]).normalized();
  // Any first direction across will do as long as all poses of a limb start along one tangent.
  Vector3d across =
      tangent.cross(std::abs(tangent.y()) < 0.8 ? Vector3d::UnitY() : Vector3d::UnitX())
          .normalized();
  for (size_t i = 0; i < count; ++i) {
    const Vector3d next =
        (points_[std::min(i + 1, count - 1)] - points_[i == 0 ? 0 : i - 1]).normalized();
    across = Eigen::Quaterniond::FromTwoVectors(tangent, next) * across;
    across = (across - next * next.dot(across)).normalized();
    tangent = next;
    frames_[i] << across, tangent.cross(across), tangent;
  }
  for (const Vector3d& p : points_)
    middle_ += p / double(count);
  for (const Vector3d& p : points_)
    reach_ = std::max(reach_, (p - middle_).norm());
}

Curve Curve::Bezier(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  std::vector<Vector3d> points;
  for (int i = 0; i <= kNumSegments; ++i) {
    const double t = double(i) / kNumSegments, s = 1 - t;
    points.emplace_back(s * s * s * a + 3 * s * s * t * b + 3 * s * t * t * c + t * t * t * d);
  }
  return Curve(std::move(points));
}

Curve Curve::Turning(const Vector3d& start, const Vector3d& direction, double length,
                     const std::function<Vector3d(double)>& turn) {
  std::vector<Vector3d> points = {start};
  Vector3d heading = direction.normalized();
  for (int i = 0; i < kNumSegments; ++i) {
    const Vector3d rotation = turn((i + 0.5) / kNumSegments) / kNumSegments;
    const double angle = rotation.norm();
    if (angle > 0) heading = Eigen::AngleAxisd(angle, rotation / angle) * heading;
    points.emplace_back(points.back() + heading * (length / kNumSegments));
  }
  return Curve(std::move(points));
}

Curve::Foot Curve::Nearest(const Vector3d& p) const {
  Foot foot;
  double smallest = std::numeric_limits<double>::infinity();
  const double num_segments = double(points_.size() - 1);
  for (size_t i = 0; i + 1 < points_.size(); ++i) {
    const Vector3d along = points_[i + 1] - points_[i];
    const double t = std::clamp((p - points_[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (p - points_[i] - t * along).squaredNorm();
    if (distance < smallest) {
      smallest = distance;
      foot.u = (double(i) + t) / num_segments;
    }
  }
  foot.distance = std::sqrt(smallest);
  return foot;
}

Vector3d Curve::Point(double u) const {
  const double place = std::clamp(u, 0.0, 1.0) * double(points_.size() - 1);
  const size_t i = std::min(static_cast<size_t>(place), points_.size() - 2);
  return points_[i] + (place - double(i)) * (points_[i + 1] - points_[i]);
}

Eigen::Matrix3d Curve::Frame(double u) const {
  const double place = std::clamp(u, 0.0, 1.0) * double(points_.size() - 1);
  const size_t i = std::min(static_cast<size_t>(place), points_.size() - 2);
  const Eigen::Quaterniond a(frames_[i]), b(frames_[i + 1]);
  return a.slerp(place - double(i), b).toRotationMatrix();
}

double Curve::Length() const {
  double length = 0;
  for (size_t i = 1; i < points_.size(); ++i)
    length += (points_[i] - points_[i - 1]).norm();
  return length;
}

double Limb::Distance(const Vector3d& p) const {
  const double away = spine.Beyond(p) - kThickest;
  if (away > 0.4) return away;
  const Curve::Foot foot = spine.Nearest(p);
  return foot.distance - radius(foot.u);
}

double Limb::Share(const Vector3d& p, double full) const {
  if (spine.Beyond(p) > far * (kThickest + margin)) return 0;
  const Curve::Foot foot = spine.Nearest(p);
  const double close = 1 - SmoothStep(near, far, foot.distance / (radius(foot.u) + margin));
  return close * SmoothStep(0.35 * full, full, foot.u);
}

Vector3d MoveWithLimb(const Limb& limb, const Curve& posed,
                      const std::function<double(double)>& thickness, const Vector3d& p) {
  const double share = limb.Share(p, limb.root);
  if (share == 0) return p;
  const double u = limb.spine.Nearest(p).u;
  Vector3d local = limb.spine.Frame(u).transpose() * (p - limb.spine.Point(u));
  local.head<2>() *= thickness(u);
  const Vector3d moved = posed.Point(u) + posed.Frame(u) * local;
  return p + share * (moved - p);
}

}  // namespace limber::content
