#include "rig/skin_point.h"

#include <cmath>

namespace limber {

Status CheckSkinPoint(const Rig& rig, const SkinPoint& point) {
  float sum = 0;
  for (size_t corner = 0; corner < 3; ++corner) {
    sum += point.weights[corner];
    if (point.vertices[corner] >= rig.mesh().num_solve_vertices) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: point of the skin: vertex %u; expected 0 to %u", rig.name().c_str(),
                   point.vertices[corner], rig.mesh().num_solve_vertices - 1);
    }
  }
  if (std::abs(sum - 1) <= 1e-4f) return {};
  return Error(StatusCode::kInvalidArgument,
               "%s: point of the skin: its weights sum to %g; expected one", rig.name().c_str(),
               static_cast<double>(sum));
}

}  // namespace limber
