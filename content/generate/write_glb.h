// A character as a binary glTF 2.0 file.
#pragma once

#include "generate/character.h"

#include <cstdint>
#include <vector>

namespace limber::content {

// One mesh node with the shapes but the first as morph targets, the picture embedded as PNG, and
// one child node per handle, marked `"extras": {"limber_handle": ...}` for `limber bake`. The
// same character gives the same bytes.
std::vector<uint8_t> WriteGlb(const Character& character);

}  // namespace limber::content
