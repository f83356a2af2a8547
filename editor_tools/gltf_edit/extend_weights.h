// Morph target weights, and animations of them, for a mesh that gets more targets.
#pragma once

#include "core/status.h"
#include "gltf_edit/gltf_patch.h"
#include "load/gltf_file.h"

#include <cstddef>

namespace limber::bake {

struct TargetCounts {
  size_t old_targets = 0, new_targets = 0;  // those that the mesh had, and those that come after
};

// Puts zeros behind the weights of meshes[mesh] and of the nodes that carry it, where they are
// written down, and behind each keyframe of every animation of them (KHR_animation_pointer too). A
// sampler that also moves something else is left to that, and copied. Errors: as AppendTargets.
Status ExtendWeights(const GltfFile& source, int mesh, const TargetCounts& counts,
                     GltfPatch* patch);

}  // namespace limber::bake
