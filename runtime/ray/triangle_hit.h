// Ray against one triangle, in double: what a hit is reported from once the triangle is known.
#pragma once

#include "core/vec3.h"

#include <array>
#include <optional>

namespace limber {

struct Double3 {
  double x = 0, y = 0, z = 0;
};

Double3 ToDouble(Vec3 v);
Vec3 ToFloat(Double3 v);
Double3 operator+(Double3 a, Double3 b);
Double3 operator-(Double3 a, Double3 b);
Double3 operator*(double s, Double3 v);
double Dot(Double3 a, Double3 b);
Double3 Cross(Double3 a, Double3 b);
double Length(Double3 v);
// True when no component is infinite or NaN.
bool IsFinite(Vec3 v);

struct TriangleHit {
  double distance = 0;                      // along the unit direction
  std::array<double, 3> barycentrics = {};  // clamped into the triangle, sum one
  Double3 point, normal;                    // the normal is unit
  bool front_facing = true;
};

// The meeting of the line with the triangle's plane, pulled to the nearest barycentrics inside: the
// caller has already established a hit, to within single precision. Nothing where the triangle has
// no area or is seen exactly edge-on. (Moeller and Trumbore 1997.)
std::optional<TriangleHit> HitTriangle(Double3 origin, Double3 unit_direction,
                                       const std::array<Vec3, 3>& corners);

}  // namespace limber
