// More morph targets for a mesh of a glTF, with all that must then be longer.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "gltf_edit/gltf_patch.h"
#include "load/gltf_file.h"

#include <span>
#include <string>

namespace limber::bake {

// Displacements of the vertices of one primitive, three numbers a vertex.
struct TargetOffsets {
  Vector<float> positions;
  Vector<float> normals;  // or empty
};

struct NewTarget {
  std::string name;
  Vector<TargetOffsets> primitives;  // one for each primitive of the mesh
};

// Appends the targets to every primitive of meshes[mesh], after those that are there; a primitive
// without targets beside some with them first gets theirs, at rest. Weights of the mesh and of its
// nodes, and every animation of them, get zeros for the new targets; extras.targetNames names all
// (unless extras is no object). source: the file that the patch began with; none of this mesh has
// been changed since. Errors, without the file's name: those of ReadAnimationChannels and
// ReadFloats; kMalformed (weights whose number is not that of the targets), kInvalidArgument (a
// name that is there already).
Status AppendTargets(const GltfFile& source, int mesh, std::span<const NewTarget> targets,
                     GltfPatch* patch);

}  // namespace limber::bake
