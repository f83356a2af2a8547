// A wish for a handle, from a glTF node, a handle file or the automatic choice; the bake snaps it.
#pragma once

#include "core/vec3.h"

#include <optional>
#include <string>

namespace limber::bake {

struct HandleSpec {
  std::string name;
  bool pinned = true;
  // Exactly one of the two: a vertex in the source's order, or a position in mesh space that is
  // snapped to the nearest vertex of the first example shape.
  std::optional<uint32_t> source_vertex;
  std::optional<Vec3> position;
  // How stiff the region that follows the handle is, beside the rest: scales its edge weights.
  double stiffness = 1;
  int node = -1;  // the glTF node that it came from, -1 for none
};

inline constexpr double kSoftestRegion = 1e-3, kStiffestRegion = 1e3;

inline bool IsRegionStiffness(double stiffness) {
  return stiffness >= kSoftestRegion && stiffness <= kStiffestRegion;
}

}  // namespace limber::bake
