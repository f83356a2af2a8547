// Scripted drags: the targets of a character's handles over time, for `limber solve` and `render`.
#pragma once

#include "generate/character.h"

#include <string>
#include <vector>

namespace limber::content {

// One stop of a drag: the handles named (all pinned ones where the list is empty) are taken
// `amount` of the way from their rest positions to those of the example shape; 1 arrives at it, a
// little more goes beyond. Handles that are not named go to rest.
struct DragStop {
  std::string shape;
  double amount = 1;
  std::vector<std::string> handles;
  int frames = 8;  // taken to get here from the stop before, eased in and out
};

// The drag as JSON text, {"frames": [{"targets": {"handle": [x, y, z]}}]}, in mesh space. Begins
// and ends at rest, so that it loops. Handles go together unless stops name them.
std::string WriteDrag(const Character& character, const std::vector<DragStop>& stops);

}  // namespace limber::content
