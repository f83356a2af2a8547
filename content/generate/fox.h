// A fox cut out of paper: a planar character with a picture on it.
#pragma once

#include "generate/character.h"

#include <string>

namespace limber::content {

// Rest and six example shapes, all in the plane z = 0; seven handles. Two units high, standing on
// y = 0. The picture's alpha cuts the paper's edge just inside the mesh.
Character MakeFox();
std::string MakeFoxDrag(const Character& fox);

}  // namespace limber::content
