#include "ray/nearest_hit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber {
namespace {

constexpr double kEqualDistance = 1e-6;
constexpr double kNowhere = std::numeric_limits<double>::infinity();

// Two directions at right angles to a unit one and to each other.
void MakeFrame(Double3 unit, Double3* across, Double3* up) {
  const Double3 other = std::abs(unit.x) < 0.6 ? Double3{1, 0, 0} : Double3{0, 1, 0};
  const Double3 raw = Cross(unit, other);
  *across = (1 / Length(raw)) * raw;
  *up = Cross(unit, *across);
}

// Twice the signed area between the ray and an edge. An edge walked the other way gives exactly
// the negative, so that neighbours agree on which side the ray is.
template <class Point>
double Side(const Point& a, const Point& b) {
  return a.x * b.y - a.y * b.x;
}

// Along the ray; infinite where it misses. (Woop, Benthin and Wald 2013, in double.)
template <class Point>
double DistanceTo(const Point& a, const Point& b, const Point& c) {
  const double u = Side(b, c), v = Side(c, a), w = Side(a, b);
  const bool outside = (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0);
  const double area = u + v + w;
  if (outside || area == 0) return kNowhere;
  const double distance = (u * a.z + v * b.z + w * c.z) / area;
  if (distance < 0) return kNowhere;
  return distance;
}

}  // namespace

std::optional<NearestHit> NearestHitFinder::Find(std::span<const Vec3> positions,
                                                 std::span<const uint32_t> triangles, Vec3 origin,
                                                 Vec3 direction, EqualHits equal) {
  const Double3 from = ToDouble(origin), raw = ToDouble(direction);
  const Double3 unit = (1 / Length(raw)) * raw;
  Double3 across, up;
  MakeFrame(unit, &across, &up);
  seen_.resize(positions.size());
  for (size_t v = 0; v < positions.size(); ++v) {
    const Double3 p = ToDouble(positions[v]) - from;
    seen_[v] = {Dot(p, across), Dot(p, up), Dot(p, unit)};
  }
  double nearest = kNowhere, found_at = kNowhere;
  std::optional<uint32_t> found;
  for (size_t t = 0; 3 * t + 2 < triangles.size(); ++t) {
    const double distance = DistanceTo(seen_[triangles[3 * t]], seen_[triangles[3 * t + 1]],
                                       seen_[triangles[3 * t + 2]]);
    if (distance == kNowhere || distance > nearest * (1 + kEqualDistance)) continue;
    // Of those as near as the nearest, the first or the last; a nearer one ends all that are not.
    const bool is_as_near = found && found_at <= distance * (1 + kEqualDistance);
    nearest = std::min(nearest, distance);
    if (is_as_near && equal == EqualHits::kFirst) continue;
    found = static_cast<uint32_t>(t);
    found_at = distance;
  }
  if (!found) return std::nullopt;
  const uint32_t* corners = &triangles[size_t{*found} * 3];
  const std::optional<TriangleHit> at = HitTriangle(
      from, unit, {positions[corners[0]], positions[corners[1]], positions[corners[2]]});
  if (!at) return std::nullopt;
  return NearestHit{*found, *at};
}

}  // namespace limber
