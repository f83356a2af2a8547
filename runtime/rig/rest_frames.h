// Rest normals and tangents for meshes whose file has none.
#pragma once

#include "rig/skin_mesh.h"

#include <array>

namespace limber {

// Fills rest_normals where it is empty: area-weighted over the triangles of each solve vertex on
// the first shape, turned to mesh space by `basis` (RigSpace::basis), smooth across seams. Fills
// rest_tangents where it is empty and there are texture coordinates: the direction in which u
// grows, orthogonal to the normal, handedness in w. Vertices without area get +z, and any tangent.
void CompleteRestFrames(const std::array<float, 9>& basis, SkinMesh* mesh);

}  // namespace limber
