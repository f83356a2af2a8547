#include "animation/clip_moments.h"

#include "core/printable.h"
#include "core/vector.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace limber::bake {
namespace {

constexpr double kEndSlack = 0.0005;  // seconds; lengths are shown to a millisecond

std::string ShortestNumber(double number) {
  char text[32];
  const auto [end, error] =
      std::to_chars(text, text + sizeof text, number, std::chars_format::fixed);
  // Numbers beyond all clips do not fit the fixed form.
  return error == std::errc() ? std::string(text, end) : std::to_string(number);
}

double RoundToDecimals(double number, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, number);
  return std::strtod(text, nullptr);
}

}  // namespace

Result<Vector<double>> CheckMoments(const AnimationClip& clip, std::span<const double> times) {
  const std::string name = "clip " + Quoted(clip.name);
  if (times.empty()) {
    return Error(StatusCode::kInvalidArgument, "%s: no moment of it was asked for", name.c_str());
  }
  Vector<double> moments;
  for (const double time : times) {
    if (!std::isfinite(time) || time < 0) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: %g is no moment of it; times are seconds from 0 on", name.c_str(), time);
    }
    if (time > clip.duration + kEndSlack) {
      return Error(StatusCode::kInvalidArgument, "%s: %g s is past its end; it is %.3f s long",
                   name.c_str(), time, clip.duration);
    }
    if (std::find(moments.begin(), moments.end(), time) != moments.end()) {
      return Error(StatusCode::kInvalidArgument,
                   "%s: the moment %g s is there twice; two equal example shapes are of no use",
                   name.c_str(), time);
    }
    moments.push_back(time);
  }
  return moments;
}

Result<Vector<double>> SpreadMoments(const AnimationClip& clip, int count, bool loops) {
  if (count > 1 && !(clip.duration > 0)) {
    return Error(StatusCode::kInvalidArgument,
                 "clip %s: it has no length, so there is only one moment to take",
                 Quoted(clip.name).c_str());
  }
  const double step = clip.duration / std::max(1, loops ? count : count - 1);
  const int decimals =
      step > 0 ? std::clamp(2 - static_cast<int>(std::floor(std::log10(step))), 0, 12) : 0;
  Vector<double> moments;
  moments.reserve(static_cast<size_t>(count));
  for (int k = 0; k < count; ++k)
    moments.push_back(RoundToDecimals(step * k, decimals));
  return moments;
}

std::string MomentName(const AnimationClip& clip, double time) {
  return clip.name + "@" + ShortestNumber(time);
}

}  // namespace limber::bake
