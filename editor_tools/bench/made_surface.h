// Two triangulated surfaces of any size, made in code, of triangles of nearly one size.
#pragma once

#include "core/vector.h"

#include <Eigen/Core>

#include <cstdint>

namespace limber::bench {

struct MadeSurface {
  Vector<Eigen::Vector3d> points;
  Vector<uint32_t> triangles;  // counter-clockwise from outside, or from +z
};

// The unit sphere, closed, of 4 n^2 + 2 points: at least so many as asked for. The first one is at
// the top (y = 1).
MadeSurface MakeSphere(int num_points);

// The unit disc in the plane z = 0, of 3 n (n + 1) + 1 points: as near to the number asked for as
// that can be. The first one is the centre, the last is on the rim.
MadeSurface MakeDisc(int num_points);

}  // namespace limber::bench
