// Which handle a ray means, without regard to the surface.
#pragma once

#include "pick/picker.h"
#include "ray/triangle_hit.h"

#include <optional>

namespace limber {

// How well one handle fits a ray. Ordered: a < b when a is the better pick.
struct HandleScore {
  double fraction = 0;  // offset over what is allowed there
  double distance = 0;  // along the ray
  double offset = 0;

  bool BetterThan(const HandleScore& other) const {
    return fraction != other.fraction ? fraction < other.fraction : distance < other.distance;
  }
};

// Nothing where the handle is out of reach, before or behind the ray's segment, or not finite.
std::optional<HandleScore> ScoreHandle(const PickRay& ray, Double3 unit_direction, Vec3 handle,
                                       const HandlePickOptions& options);

}  // namespace limber
