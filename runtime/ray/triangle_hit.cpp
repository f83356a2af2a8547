#include "ray/triangle_hit.h"

#include <algorithm>
#include <cmath>

namespace limber {

Double3 ToDouble(Vec3 v) {
  return {v.x, v.y, v.z};
}

Vec3 ToFloat(Double3 v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Double3 operator+(Double3 a, Double3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

Double3 operator-(Double3 a, Double3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

Double3 operator*(double s, Double3 v) {
  return {s * v.x, s * v.y, s * v.z};
}

double Dot(Double3 a, Double3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

Double3 Cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double Length(Double3 v) {
  return std::sqrt(Dot(v, v));
}

bool IsFinite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::optional<TriangleHit> HitTriangle(Double3 origin, Double3 unit_direction,
                                       const std::array<Vec3, 3>& corners) {
  const Double3 a = ToDouble(corners[0]);
  const Double3 b = ToDouble(corners[1]);
  const Double3 c = ToDouble(corners[2]);
  const Double3 ab = b - a, ac = c - a;
  const Double3 normal = Cross(ab, ac);
  const double area = Length(normal);
  const double determinant = -Dot(normal, unit_direction);
  if (!(area > 0) || determinant == 0) return std::nullopt;

  const Double3 from_a = origin - a;
  const Double3 turned = Cross(from_a, unit_direction);
  double v = Dot(ac, turned) / determinant;
  double w = -Dot(ab, turned) / determinant;
  v = std::clamp(v, 0.0, 1.0);
  w = std::clamp(w, 0.0, 1.0);
  if (const double sum = v + w; sum > 1) {
    v /= sum;
    w = 1 - v;
  }
  TriangleHit hit;
  hit.barycentrics = {std::max(0.0, 1 - v - w), v, w};
  hit.point = a + v * ab + w * ac;
  hit.distance = Dot(hit.point - origin, unit_direction);
  hit.normal = (1 / area) * normal;
  hit.front_facing = determinant > 0;
  return hit;
}

}  // namespace limber
