// How stiff the surface is, vertex by vertex, as an artist painted it.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_mesh.h"

#include <string>

namespace limber::bake {

inline constexpr char kStiffnessAttribute[] = "_LIMBER_STIFFNESS";

// [D] factors on the weights of the edges at each draw vertex, all within kSoftestRegion and
// kStiffestRegion; empty where there is nothing to read. From the vertex attribute `attribute`:
//   - "COLOR_0", "COLOR_1", ...: the first channel c as 100^(2c - 1), so mid-grey is neutral, black
//     a hundredth and white a hundred times as stiff;
//   - any other: one float a vertex, the factor itself.
// Empty name: kStiffnessAttribute, where the mesh has it. Errors, without the file's name:
// kNotFound (a primitive lacks the attribute that was asked for), kMalformed (a factor out of
// range, which is named with its vertex), those of ReadMeshAttribute.
Result<Vector<float>> ReadVertexStiffness(const GltfFile& file, const GltfMorphMesh& mesh,
                                          const std::string& attribute);

}  // namespace limber::bake
