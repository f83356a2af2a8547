// One animation of a glTF, and the state that it gives the scene at a moment.
#pragma once

#include "clips/keyframe_track.h"
#include "clips/node_transforms.h"
#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <string>

namespace limber {

enum class ClipPath { kTranslation, kRotation, kScale, kWeights };

struct ClipChannel {
  int node = -1;
  ClipPath path = ClipPath::kTranslation;
  KeyframeTrack track;
};

struct AnimationClip {
  int index = -1;
  std::string name;     // "clip_2" where the file has none
  double duration = 0;  // seconds: the last keyframe of all channels
  // What moves nodes and morph target weights. Channels of extensions are left out.
  Vector<ClipChannel> channels;
};

// The animation that `wanted` names, by its name or its index in decimal; empty: the only one.
// Errors, without the file's name: kNotFound (no animation at all, or none of that name),
// kInvalidArgument (several fit); they list the clips with their lengths.
Result<int> FindAnimationClip(const GltfFile& file, const std::string& wanted);

// Errors, without the file's name: those of ReadAnimationChannels and ReadKeyframeTrack; kMalformed
// (a node that has a matrix, or weights of a node without morph targets).
Result<AnimationClip> ReadAnimationClip(const GltfFile& file, int animation);

// Number of morph targets of the mesh of a node: the most that one of its primitives has; 0 without
// a mesh.
size_t NumMorphTargets(const GltfFile& file, int node);

// Moves the nodes that the clip moves. local: one for each node.
void ApplyClip(const AnimationClip& clip, double time, Vector<NodeTransform>* local);

// The same for the morph target weights of one node; where the clip has none they stay.
void ApplyClipWeights(const AnimationClip& clip, double time, int node, Vector<double>* weights);

}  // namespace limber
