// Takes the last kinks out of an example shape.
#pragma once

#include "generate/character.h"

#include <cstdint>
#include <vector>

namespace limber::content {

// Smooths how far the vertices of `shape` have moved from `rest` over the mesh, in a number of
// small passes; whatever varies slowly stays as it is. Vertices on a rim heed the rim alone, so
// that it does not shrink. `strength` in [0, 1] per vertex: 0 leaves it where it is. All share one
// order of vertices.
void SmoothOffsets(const std::vector<uint32_t>& triangles, const std::vector<Vector3d>& rest,
                   int passes, const std::vector<double>& strength, std::vector<Vector3d>* shape);

}  // namespace limber::content
