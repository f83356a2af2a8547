// Values over time, given at keyframes (glTF 2.0, appendix C).
#pragma once

#include "clips/animation_channels.h"
#include "core/status.h"
#include "core/vector.h"

#include <Eigen/Geometry>

#include <span>

namespace limber {

struct KeyframeTrack {
  Interpolation interpolation = Interpolation::kLinear;
  size_t components = 1;  // C: numbers of one value
  Vector<double> times;   // K >= 1, seconds, from 0, strictly increasing
  // K * C; with cubic splines 3 * K * C: of each keyframe the tangent on the way in, the value, the
  // tangent on the way out.
  Vector<double> values;

  // Number of the values' numbers that K keyframes have.
  size_t num_values() const {
    return times.size() * components * (interpolation == Interpolation::kCubicSpline ? 3 : 1);
  }
};

// Reads a channel whose values have `components` numbers each: 3 or 4 as vectors, others (morph
// target weights) as scalars in a row. Errors, without the file's name: those of ReadFloats;
// kMalformed (times that do not increase from 0 on, a number of values that does not fit).
Result<KeyframeTrack> ReadKeyframeTrack(const GltfFile& file, const AnimationChannel& channel,
                                        size_t components, bool is_vector);

// The value at a time, each number on its own; before the first and after the last keyframe it is
// theirs. value: [C].
void SampleTrack(const KeyframeTrack& track, double time, std::span<double> value);
Vector<double> SampleTrack(const KeyframeTrack& track, double time);

// The same of rotations (C = 4, x y z w): LINEAR along the shorter great arc at constant speed; a
// unit quaternion. Allocates nothing. No rotation where the keyframes' quaternions are zero.
Eigen::Quaterniond SampleRotation(const KeyframeTrack& track, double time);

}  // namespace limber
