// A round little dragon that squashes, stretches, puffs up, curls its tail, leans, waves and jumps.
#pragma once

#include "generate/character.h"

#include <string>

namespace limber::content {

// Rest and eight example shapes; the body is one closed surface, the eyes are two more. Twelve
// handles. About two units high, standing on y = 0, facing +z; its left is +x.
Character MakeDragonlet();
// Visits most of the example shapes, some of them with a few handles only.
std::string MakeDragonletDrag(const Character& dragonlet);

}  // namespace limber::content
