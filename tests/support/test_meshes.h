// Small characters made in code, as the importer would hand them over.
#pragma once

#include "import/raw_character.h"

namespace limber::test {

// The paper's figure 1: a unit square of resolution x resolution quads in the xy plane with three
// example shapes of width 1, 1.6 and 2.4, the middle one puffed outwards, the last one thinned.
// Marked handles: "left", "centre" and "right" on the middle line.
bake::RawCharacter MakeStretchSquare(int resolution);

// A closed cylinder along y, radius 0.25, height 2, with three shapes: straight, bent by 90 degrees
// and squashed to half its height and bulging. Handles "bottom", "middle" (free) and "top".
bake::RawCharacter MakeBendCylinder(int around, int along);

}  // namespace limber::test
