// Which moments of a clip become example shapes, and what these are called.
#pragma once

#include "clips/animation_clip.h"
#include "core/status.h"
#include "core/vector.h"

#include <span>
#include <string>

namespace limber::bake {

// The given times as moments of the clip: those up to half a millisecond past its end, as people
// read the length in a message, are the end. Errors, without the file's name: kInvalidArgument (no
// time at all, one that is negative, not finite, past the end or there twice).
Result<Vector<double>> CheckMoments(const AnimationClip& clip, std::span<const double> times);

// `count` moments spread evenly. Of a clip that loops (its end is its start) each stands for an
// equal share, and the end is left out: k D / count. Of another one the last moment is the end:
// k D / (count - 1). Times are rounded to two digits more than their distance needs, so that they
// have short names. Errors, without the file's name: kInvalidArgument (several moments of a clip
// without length).
Result<Vector<double>> SpreadMoments(const AnimationClip& clip, int count, bool loops);

// "Run@0.1": the clip's name and the time in seconds, as short as tells it from all others.
std::string MomentName(const AnimationClip& clip, double time);

}  // namespace limber::bake
