// Dragging in the view plane: the plane through the grabbed point, parallel to the image.
#pragma once

#include "core/vec3.h"
#include "pick/picker.h"

#include <optional>
#include <span>

namespace limber::viewer {

// One drag, from button down to button up. A handle's target, or any other point, follows the
// pointer: it keeps the distance from the pointer at which it was grabbed, so nothing jumps when a
// dot is caught off its middle. All in mesh space.
class ViewPlaneDrag {
 public:
  // `grabbed` is the point on the plane that the pointer caught (a dot's centre or a point of the
  // skin), `moved` what shall move (the handle's target), `forward` the camera's viewing direction
  // and `pointer` the ray under the pointer. Nothing where the ray runs along the plane.
  static std::optional<ViewPlaneDrag> Begin(const PickRay& pointer, Vec3 grabbed, Vec3 moved,
                                            Vec3 forward);

  // Where `moved` belongs with the pointer here; nothing where the ray does not meet the plane in
  // front of its origin (a steep perspective ray), so that the last position stays.
  std::optional<Vec3> PositionAt(const PickRay& pointer) const;

 private:
  ViewPlaneDrag() = default;
  Vec3 start_;    // where the pointer met the plane at first
  Vec3 moved_;    // what moves, at first
  Vec3 forward_;  // normal of the plane
};

// Which of the points is nearest to `position`; those whose `usable` is false do not count. The
// lowest index wins a tie; -1 where there is none. usable.size() == points.size().
int NearestPoint(Vec3 position, std::span<const Vec3> points, std::span<const bool> usable);

}  // namespace limber::viewer
