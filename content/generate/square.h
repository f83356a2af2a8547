// The square of figure 1 of Wampler 2016.
#pragma once

#include "generate/character.h"

#include <string>

namespace limber::content {

// A unit square in three example shapes: width 1, width 1.6 puffed outwards, width 2.4 thinned
// inwards. Handles "left", "centre" (free) and "right" on its middle line.
Character MakeSquare();
// The right handle pulled out beyond the widest shape and back, the left one held.
std::string MakeSquareDrag(const Character& square);

}  // namespace limber::content
