// The deformed mesh as OBJ text, in the vertex and face order of the source it was baked from.
#pragma once

#include "core/vec3.h"
#include "import/source_faces.h"
#include "rig/skin_mesh.h"

#include <span>
#include <string>

namespace limber::cli {

// solve_positions: [V], mesh space. Nine digits, so that reading the text gives the same floats.
// A source vertex that no face uses keeps its number and stands at the origin.
std::string ObjText(const SkinMesh& mesh, const bake::SourceFaces& faces,
                    std::span<const Vec3> solve_positions);

}  // namespace limber::cli
