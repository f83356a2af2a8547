#include "pick/handle_pick.h"

#include <algorithm>

namespace limber {

std::optional<HandleScore> ScoreHandle(const PickRay& ray, Double3 unit_direction, Vec3 handle,
                                       const HandlePickOptions& options) {
  if (!IsFinite(handle)) return std::nullopt;
  const Double3 to_handle = ToDouble(handle) - ToDouble(ray.origin);
  HandleScore score;
  score.distance = Dot(to_handle, unit_direction);
  if (!(score.distance >= ray.near_distance && score.distance <= ray.far_distance)) {
    return std::nullopt;
  }
  score.offset = Length(to_handle - score.distance * unit_direction);
  const double allowed = options.radius + options.cone_tangent * std::max(0.0, score.distance);
  if (!(score.offset <= allowed)) return std::nullopt;
  score.fraction = allowed > 0 ? score.offset / allowed : 0;
  return score;
}

}  // namespace limber
