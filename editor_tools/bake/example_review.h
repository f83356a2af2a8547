// Example shapes that cost time and memory and say nothing new.
#pragma once

#include "core/vector.h"
#include "import/raw_character.h"

#include <span>
#include <string>

namespace limber::bake {

// One line for each such shape, for people:
//   - the same as another, moved and turned as a whole, where the bake is one with `rotations`
//     (the solver then does that by itself);
//   - a mix of others, sum b_t x_t with b_t >= 0 and sum b_t = 1, which blending reaches anyway.
// Nearly is enough: to kSameShape of the size at every vertex. Of two that are the same the later
// one is named. shapes: S of V x 3, solve or draw vertices; names: S.
Vector<std::string> ReviewExamples(std::span<const PointMatrix> shapes,
                                   std::span<const std::string> names, bool rotations);

inline constexpr double kSameShape = 1e-4;  // of the first shape's diagonal

}  // namespace limber::bake
