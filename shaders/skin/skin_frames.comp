// Pass 2: for every draw vertex its position, and the normal and tangent of the *deformed*
// surface. The triangles of the vertex's normal group give
//   n  = sum of cross products                 (area-weighted normal)
//   f1, f2 = the two rest tangent directions pushed forward by the deformation (averaged).
// The frame nearest to (f1, f2) in the plane of n carries the authored normal; the tangent is
// pushed forward itself and made orthogonal again. The same arithmetic as skin/skin_frames.cpp.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/skin_layout.h"

layout(local_size_x = LIMBER_SKIN_GROUP_SIZE) in;

struct DrawVertex {
  vec3 normal;
  uint solve_vertex;
  vec3 tangent;
  uint normal_group;
};

struct Corner {
  uvec2 others;
  vec2 first;
  vec2 second;
};

layout(std430, binding = LIMBER_SKIN_SOLVE_POSITIONS) readonly buffer Positions {
  vec4 positions[];
};
layout(std430, binding = LIMBER_SKIN_DRAW_VERTICES) readonly buffer DrawVertices {
  DrawVertex draw_vertices[];
};
layout(std430, binding = LIMBER_SKIN_GROUP_CORNERS) readonly buffer GroupCorners {
  uint group_corners[];
};
layout(std430, binding = LIMBER_SKIN_CORNERS) readonly buffer Corners { Corner corners[]; };
layout(std430, binding = LIMBER_SKIN_VERTICES) writeonly buffer Vertices { float vertices[]; };

layout(push_constant) uniform Push {
  vec3 origin;
  float inverse_scale;
  uint num_solve_vertices;
  uint num_draw_vertices;
};

// Bounds are written so that NaN passes none of them.
bool IsDirection(vec3 v) {
  const float squared = dot(v, v);
  return squared > LIMBER_SKIN_TINY && squared < LIMBER_SKIN_HUGE;
}

vec3 AnyPerpendicular(vec3 unit) {
  const vec3 axis = abs(unit.x) < 0.57 ? vec3(1, 0, 0)
                    : abs(unit.y) < 0.57 ? vec3(0, 1, 0) : vec3(0, 0, 1);
  return normalize(cross(unit, axis));
}

// The direction of v as far as it is orthogonal to a unit vector; any orthogonal one where nothing
// is left of it.
vec3 OrthogonalDirection(vec3 v, vec3 unit) {
  const vec3 rest = v - dot(unit, v) * unit;
  if (!IsDirection(rest)) return AnyPerpendicular(unit);
  const vec3 direction = normalize(rest);
  if (dot(rest, rest) > 0.01 * dot(v, v)) return direction;
  // Little is left, and rounding has put some of `unit` back into it: once more, which is enough
  // unless it was rounding altogether.
  const vec3 again = direction - dot(unit, direction) * unit;
  return dot(again, again) > 0.25 ? normalize(again) : AnyPerpendicular(unit);
}

// What the triangles of a normal group say about the surface at `centre`.
struct Sums {
  vec3 n, first, second;
};

Sums SumCorners(uint group, vec3 centre) {
  Sums sums = Sums(vec3(0), vec3(0), vec3(0));
  const uint end = group_corners[group + 1];
  for (uint c = group_corners[group]; c < end; ++c) {
    const Corner corner = corners[c];
    const vec3 e1 = (positions[corner.others.x].xyz - centre) * inverse_scale;
    const vec3 e2 = (positions[corner.others.y].xyz - centre) * inverse_scale;
    sums.n += cross(e1, e2);
    sums.first += corner.first.x * e1 + corner.first.y * e2;
    sums.second += corner.second.x * e1 + corner.second.y * e2;
  }
  // Differences and sums of finite numbers may have left the range: nothing of it is used then.
  const float squares = dot(sums.n, sums.n) + dot(sums.first, sums.first) +
                        dot(sums.second, sums.second);
  if (squares < LIMBER_SKIN_HUGE) return sums;
  return Sums(vec3(0), vec3(0), vec3(0));
}

// `authored` is in the frame with normal n that is nearest to the pushed directions: the
// two-dimensional polar decomposition.
vec3 CarryNormal(vec3 authored, vec3 n, vec3 first, vec3 second) {
  const vec3 t = OrthogonalDirection(first, n);
  const vec3 b = cross(n, t);
  vec2 turn = vec2(dot(first, t) + dot(second, b), dot(first, b) - dot(second, t));
  turn = dot(turn, turn) > LIMBER_SKIN_TINY ? normalize(turn) : vec2(1, 0);
  return normalize(authored.x * (turn.x * t + turn.y * b) +
                   authored.y * (turn.x * b - turn.y * t) + authored.z * n);
}

void main() {
  const uint d = gl_GlobalInvocationID.x;
  if (d >= num_draw_vertices) return;
  const DrawVertex vertex = draw_vertices[d];
  const vec3 centre = positions[vertex.solve_vertex].xyz;
  const Sums sums = SumCorners(vertex.normal_group, centre);

  vec3 normal = vertex.normal;   // where no triangle has area: as authored
  if (IsDirection(sums.n)) {
    normal = CarryNormal(vertex.normal, normalize(sums.n), sums.first, sums.second);
  }
  const vec3 tangent = OrthogonalDirection(
      sums.first * vertex.tangent.x + sums.second * vertex.tangent.y, normal);

  const vec3 position = centre + origin;
  const uint base = d * LIMBER_SKIN_VERTEX_FLOATS;
  vertices[base] = position.x;
  vertices[base + 1] = position.y;
  vertices[base + 2] = position.z;
  vertices[base + 3] = normal.x;
  vertices[base + 4] = normal.y;
  vertices[base + 5] = normal.z;
  vertices[base + 6] = tangent.x;
  vertices[base + 7] = tangent.y;
  vertices[base + 8] = tangent.z;
  vertices[base + 9] = vertex.tangent.z;
}
