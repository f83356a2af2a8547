// A place on the skin, wherever the skin goes.
#pragma once

#include "core/status.h"
#include "rig/rig.h"

#include <array>
#include <cstdint>

namespace limber {

// The weighted mean of three solve vertices: a triangle's corners and barycentric coordinates. A
// vertex is {v, v, v} with weights {1, 0, 0}.
struct SkinPoint {
  std::array<uint32_t, 3> vertices = {};
  std::array<float, 3> weights = {1, 0, 0};  // sum one
};

// kInvalidArgument: a vertex that the rig's mesh has not, weights that do not sum to one.
Status CheckSkinPoint(const Rig& rig, const SkinPoint& point);

}  // namespace limber
