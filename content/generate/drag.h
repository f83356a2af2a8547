// Scripted drags: the targets of a character's handles over time, for `limber solve` and `render`.
#pragma once

#include "generate/character.h"
#include "generate/pose.h"
#include "generate/space_warp.h"

#include <functional>
#include <string>
#include <vector>

namespace limber::content {

// One stop of a drag: gestures at these amounts, all others gone.
struct DragStop {
  GestureMix mix;
  int frames = 8;  // taken to get here from the stop before
};

// Where a mix of gestures takes the points of the rest surface.
using Posing = std::function<SpaceWarp(const GestureMix&)>;

// The drag as JSON text, {"frames": [{"targets": {"handle": [x, y, z]}}]}, in mesh space. Begins at
// rest, and ends there where the last stop is rest, so that it loops. It is the amounts of the
// gestures that change over time, eased, and slightly overshooting before they settle; the
// handles go where `posing` takes them, that is on arcs where something bends. An example shape
// named like a gesture is met exactly where that gesture alone has the amount 1.
std::string WriteDrag(const Character& character, const Posing& posing,
                      const std::vector<DragStop>& stops);

}  // namespace limber::content
