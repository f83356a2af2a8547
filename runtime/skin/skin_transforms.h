// The solver's result as skinning takes it: for every handle and shape one affine 3x4 matrix.
//
//   q_p = origin + scale * basis * sum_h W_hp sum_s A_hs [P_sp; 1]       (eq. 6)
//
// with P in rig space. `matrices` already contains scale and basis, so that the sum is in mesh
// units and only `origin` remains to be added (kept apart: it would cost digits in the sum).
#pragma once

#include "core/vec3.h"

#include <span>

namespace limber {

struct SkinTransforms {
  std::span<const float> matrices;  // [H][S][3][4] row-major; last column the translation
  Vec3 origin;                      // mesh space
};

}  // namespace limber
