// The edge groups that a bake wrote for tools.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"
#include "rig/rig.h"

namespace limber::inspect {

// [V] edge group of each solve vertex of the rig, which was loaded from `file`. Errors, beginning
// with the file: kNotFound (a file baked before groups were written: bake it again), kMalformed (no
// integer, or not below the number of groups).
Result<Vector<int>> ReadVertexGroups(const GltfFile& file, int gltf_mesh, const Rig& rig);

}  // namespace limber::inspect
