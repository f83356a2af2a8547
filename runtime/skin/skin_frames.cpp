#include "skin/skin_frames.h"

#include "skin/kernels/skin_kernels.h"
#include "skin/vec3_math.h"

#include <cmath>

namespace limber {
namespace {

constexpr float kTiny = kTinySquare, kHuge = kHugeSquare;

// Neither without a length, nor too long, nor infinite or NaN.
bool IsDirection(Vec3 v) {
  const float squared = Dot(v, v);
  return squared > kTiny && squared < kHuge;
}

Vec3 Normalized(Vec3 v) {
  return (1 / std::sqrt(Dot(v, v))) * v;
}

Vec3 AnyPerpendicular(Vec3 unit) {
  const Vec3 axis = std::abs(unit.x) < 0.57f   ? Vec3{1, 0, 0}
                    : std::abs(unit.y) < 0.57f ? Vec3{0, 1, 0}
                                               : Vec3{0, 0, 1};
  return Normalized(Cross(unit, axis));
}

// The direction of v as far as it is orthogonal to a unit vector; any orthogonal one where nothing
// is left of it.
Vec3 OrthogonalDirection(Vec3 v, Vec3 unit) {
  const Vec3 rest = v - Dot(unit, v) * unit;
  if (!IsDirection(rest)) return AnyPerpendicular(unit);
  const Vec3 direction = Normalized(rest);
  if (Dot(rest, rest) > 0.01f * Dot(v, v)) return direction;
  // Little is left, and rounding has put some of `unit` back into it: once more, which is enough
  // unless it was rounding altogether.
  const Vec3 again = direction - Dot(unit, direction) * unit;
  return Dot(again, again) > 0.25f ? Normalized(again) : AnyPerpendicular(unit);
}

// Of all frames with normal n, the one nearest to the pushed directions: the two-dimensional polar
// decomposition, so that neither of the two arbitrary rest directions is preferred under shear.
void FitFrame(Vec3 n, SurfaceFrame* frame) {
  const Vec3 t = OrthogonalDirection(frame->first, n);
  const Vec3 b = Cross(n, t);
  float c = Dot(frame->first, t) + Dot(frame->second, b);
  float s = Dot(frame->first, b) - Dot(frame->second, t);
  const float length = std::sqrt(c * c + s * s);
  c = length * length > kTiny ? c / length : 1;
  s = length * length > kTiny ? s / length : 0;
  frame->t = c * t + s * b;
  frame->b = c * b - s * t;
  frame->n = n;
}

}  // namespace

SurfaceFrame ComputeSurfaceFrame(const SkinTopology& topology, uint32_t group,
                                 std::span<const Vec3> positions) {
  SurfaceFrame frame;
  Vec3 n;
  const Vec3 centre = positions[topology.group_solve_vertex[group]];
  for (uint32_t c = topology.group_corners[group]; c < topology.group_corners[group + 1]; ++c) {
    const SkinCorner& corner = topology.corners[c];
    const Vec3 e1 = topology.inverse_scale * (positions[corner.a] - centre);
    const Vec3 e2 = topology.inverse_scale * (positions[corner.b] - centre);
    n = n + Cross(e1, e2);
    frame.first = frame.first + corner.first[0] * e1 + corner.first[1] * e2;
    frame.second = frame.second + corner.second[0] * e1 + corner.second[1] * e2;
  }
  // Differences and sums of finite numbers may have left the range: nothing of it is used then.
  if (!(Dot(n, n) + Dot(frame.first, frame.first) + Dot(frame.second, frame.second) < kHuge)) {
    return {};
  }
  frame.valid = IsDirection(n) ? 1 : 0;
  if (frame.valid != 0) FitFrame(Normalized(n), &frame);
  return frame;
}

void ApplyFrame(const SurfaceFrame& frame, const SkinDrawVertex& vertex, Vec3* normal,
                Tangent* tangent) {
  *normal = vertex.normal;
  if (frame.valid != 0) {
    *normal = Normalized(vertex.normal.x * frame.t + vertex.normal.y * frame.b +
                         vertex.normal.z * frame.n);
  }
  const Vec3 t = vertex.tangent[0] * frame.first + vertex.tangent[1] * frame.second;
  tangent->direction = OrthogonalDirection(t, *normal);
  tangent->handedness = vertex.handedness;
}

}  // namespace limber
