#include "clips/keyframe_track.h"

#include "core/vector.h"
#include "load/gltf_accessor.h"

#include <algorithm>
#include <array>

namespace limber {
namespace {

// Between which keyframes a time lies, and where.
struct Segment {
  size_t from = 0, to = 0;
  double fraction = 0;  // 0 at `from`, below 1
  double duration = 0;  // seconds
};

Segment FindSegment(const Vector<double>& times, double time) {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {};
  Segment segment;
  segment.from = segment.to = static_cast<size_t>(after - times.begin()) - 1;
  if (after == times.end()) return segment;
  ++segment.to;
  segment.duration = times[segment.to] - times[segment.from];
  segment.fraction = (time - times[segment.from]) / segment.duration;
  return segment;
}

// The numbers that stand for one keyframe: its value, or with cubic splines tangents around it.
enum class SplinePart : size_t { kInTangent = 0, kValue = 1, kOutTangent = 2 };

std::span<const double> KeyPart(const KeyframeTrack& track, size_t key, SplinePart part) {
  const bool is_spline = track.interpolation == Interpolation::kCubicSpline;
  const size_t row = is_spline ? 3 * key + static_cast<size_t>(part) : key;
  return std::span(track.values).subspan(row * track.components, track.components);
}

void Linear(std::span<const double> from, std::span<const double> to, double u,
            std::span<double> value) {
  for (size_t c = 0; c < value.size(); ++c)
    value[c] = (1 - u) * from[c] + u * to[c];
}

// Hermite's basis (glTF 2.0, appendix C.5); tangents are per second.
void CubicSpline(const KeyframeTrack& track, const Segment& segment, std::span<double> value) {
  const double u = segment.fraction, u2 = u * u, u3 = u2 * u;
  const auto from = KeyPart(track, segment.from, SplinePart::kValue);
  const auto to = KeyPart(track, segment.to, SplinePart::kValue);
  const auto out = KeyPart(track, segment.from, SplinePart::kOutTangent);
  const auto in = KeyPart(track, segment.to, SplinePart::kInTangent);
  for (size_t c = 0; c < value.size(); ++c) {
    value[c] = (2 * u3 - 3 * u2 + 1) * from[c] + (u3 - 2 * u2 + u) * segment.duration * out[c] +
               (3 * u2 - 2 * u3) * to[c] + (u3 - u2) * segment.duration * in[c];
  }
}

Eigen::Quaterniond UnitQuaternion(std::span<const double> xyzw) {
  const Eigen::Quaterniond q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  return q.norm() > 0 ? q.normalized() : Eigen::Quaterniond::Identity();
}

Result<Vector<double>> ReadNumbers(const GltfFile& file, const AccessorRequest& request) {
  const Result<Vector<float>> numbers = ReadFloats(file, request);
  if (!numbers.ok()) return numbers.status();
  return Vector<double>(numbers->begin(), numbers->end());
}

Status CheckTimes(const Vector<double>& times, const AnimationChannel& channel) {
  for (size_t k = 0; k < times.size(); ++k) {
    if (times[k] < 0 || (k > 0 && times[k] <= times[k - 1])) {
      return Error(StatusCode::kMalformed,
                   "%s: keyframe %zu is at %g s, and times must increase from 0 on; export the "
                   "animation again",
                   channel.place.c_str(), k, times[k]);
    }
  }
  return {};
}

}  // namespace

Result<KeyframeTrack> ReadKeyframeTrack(const GltfFile& file, const AnimationChannel& channel,
                                        size_t components, bool is_vector) {
  KeyframeTrack track;
  track.interpolation = channel.interpolation;
  track.components = components;
  Result<Vector<double>> times = ReadNumbers(file, {channel.input, 1, channel.place + ".input"});
  if (!times.ok()) return times.status();
  track.times = std::move(*times);
  LIMBER_RETURN_IF_ERROR(CheckTimes(track.times, channel));
  const size_t width = is_vector ? components : 1;
  AccessorRequest request{channel.output, static_cast<int>(width), channel.place + ".output"};
  request.expected_count = static_cast<int64_t>(track.num_values() / width);
  Result<Vector<double>> values = ReadNumbers(file, request);
  if (!values.ok()) return values.status();
  track.values = std::move(*values);
  return track;
}

void SampleTrack(const KeyframeTrack& track, double time, std::span<double> value) {
  const Segment segment = FindSegment(track.times, time);
  const auto from = KeyPart(track, segment.from, SplinePart::kValue);
  if (segment.from == segment.to || track.interpolation == Interpolation::kStep) {
    std::copy(from.begin(), from.end(), value.begin());
  } else if (track.interpolation == Interpolation::kCubicSpline) {
    CubicSpline(track, segment, value);
  } else {
    Linear(from, KeyPart(track, segment.to, SplinePart::kValue), segment.fraction, value);
  }
}

Vector<double> SampleTrack(const KeyframeTrack& track, double time) {
  Vector<double> value(track.components);
  SampleTrack(track, time, value);
  return value;
}

Eigen::Quaterniond SampleRotation(const KeyframeTrack& track, double time) {
  if (track.interpolation != Interpolation::kLinear) {
    std::array<double, 4> xyzw{};
    SampleTrack(track, time, xyzw);
    return UnitQuaternion(xyzw);
  }
  const Segment segment = FindSegment(track.times, time);
  const Eigen::Quaterniond from = UnitQuaternion(KeyPart(track, segment.from, SplinePart::kValue));
  const Eigen::Quaterniond to = UnitQuaternion(KeyPart(track, segment.to, SplinePart::kValue));
  return from.slerp(segment.fraction, to);
}

}  // namespace limber
