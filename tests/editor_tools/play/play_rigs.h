// Characters made and baked in code, for the player's tests.
#pragma once

#include "rig/rig.h"

#include <memory>

namespace limber::test {

// A closed cylinder of height 2 along y, radius 0.25: handles "bottom" and "top" pinned, "middle"
// free.
std::shared_ptr<const Rig> BakeCylinder();
// The same as a file of format version 1 has it, in which the skin cannot be held.
std::shared_ptr<const Rig> BakeCylinderOfVersion1();
// A flat square in the xy plane, x from 0 to 1: handles "left" and "right" pinned, "centre" free.
std::shared_ptr<const Rig> BakeSquare();

}  // namespace limber::test
