// The deformed mesh as OBJ text, in the vertex and face order of the source it was baked from.
#pragma once

#include "core/vec3.h"
#include "rig/skin_mesh.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace limber::cli {

// Polygons as the source had them: sizes[i] corners each, in source vertex numbers from 0.
struct SourceFaces {
  std::vector<uint32_t> sizes;
  std::vector<uint32_t> corners;
};

// The triangles of the mesh in source vertex numbers: what is known without a memory of polygons.
SourceFaces TrianglesOfSource(const SkinMesh& mesh);

// solve_positions: [V], mesh space. Nine digits, so that reading the text gives the same floats.
// A source vertex that no face uses keeps its number and stands at the origin.
std::string ObjText(const SkinMesh& mesh, const SourceFaces& faces,
                    std::span<const Vec3> solve_positions);

}  // namespace limber::cli
