// The channels of a glTF's animations as its JSON has them: who is moved, by which accessors.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <cstddef>
#include <string>

namespace limber {

enum class Interpolation { kStep, kLinear, kCubicSpline };

// One channel with its sampler (glTF 2.0, section 3.11). Node, sampler and accessors are in the
// file.
struct AnimationChannel {
  std::string place;  // for messages: "animations[2].channels[5]"
  size_t sampler = 0;
  int node = -1;        // -1: what it moves is no node
  std::string path;     // "translation", "rotation", "scale", "weights", or an extension's
  std::string pointer;  // of KHR_animation_pointer; otherwise empty
  int input = -1;       // accessor of the times
  int output = -1;      // accessor of the values
  Interpolation interpolation = Interpolation::kLinear;
};

size_t NumAnimations(const GltfFile& file);

// The animation's name, or "clip_2" where it has none.
std::string AnimationName(const GltfFile& file, size_t animation);

// Errors, without the file's name: kMalformed (a member that is missing or of another type, a
// number that is not in the file, an interpolation that glTF does not know).
Result<Vector<AnimationChannel>> ReadAnimationChannels(const GltfFile& file, size_t animation);

}  // namespace limber
