#include "viewer/play_drag.h"

#include <cmath>
#include <limits>

namespace limber::viewer {
namespace {

double Dot(Vec3 a, Vec3 b) {
  return double{a.x} * b.x + double{a.y} * b.y + double{a.z} * b.z;
}

Vec3 AddScaled(Vec3 a, double s, Vec3 b) {
  return {static_cast<float>(a.x + s * b.x), static_cast<float>(a.y + s * b.y),
          static_cast<float>(a.z + s * b.z)};
}

// Where the ray meets the plane through `point` with that normal.
std::optional<Vec3> MeetPlane(const PickRay& ray, Vec3 point, Vec3 normal) {
  const double approach = Dot(ray.direction, normal);
  // A millionth: such a ray would throw the point out of sight, pixels apart or not.
  const double lengths = std::sqrt(Dot(ray.direction, ray.direction) * Dot(normal, normal));
  if (!(std::abs(approach) > 1e-6 * lengths)) return std::nullopt;
  const double along = Dot(AddScaled(point, -1, ray.origin), normal) / approach;
  if (!std::isfinite(along) || along < 0) return std::nullopt;
  return AddScaled(ray.origin, along, ray.direction);
}

}  // namespace

std::optional<ViewPlaneDrag> ViewPlaneDrag::Begin(const PickRay& pointer, Vec3 grabbed, Vec3 moved,
                                                  Vec3 forward) {
  const std::optional<Vec3> start = MeetPlane(pointer, grabbed, forward);
  if (!start) return std::nullopt;
  ViewPlaneDrag drag;
  drag.start_ = *start;
  drag.moved_ = moved;
  drag.forward_ = forward;
  return drag;
}

std::optional<Vec3> ViewPlaneDrag::PositionAt(const PickRay& pointer) const {
  const std::optional<Vec3> now = MeetPlane(pointer, start_, forward_);
  if (!now) return std::nullopt;
  return AddScaled(moved_, 1, AddScaled(*now, -1, start_));
}

int NearestPoint(Vec3 position, std::span<const Vec3> points, std::span<const bool> usable) {
  int nearest = -1;
  double smallest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < points.size(); ++i) {
    if (!usable[i]) continue;
    const Vec3 apart = AddScaled(points[i], -1, position);
    if (const double distance = Dot(apart, apart); distance < smallest) {
      smallest = distance;
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

}  // namespace limber::viewer
