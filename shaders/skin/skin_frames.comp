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

bool IsDirection(vec3 v) { return dot(v, v) > LIMBER_SKIN_TINY; }

vec3 AnyPerpendicular(vec3 unit) {
  const vec3 axis = abs(unit.x) < 0.57 ? vec3(1, 0, 0)
                    : abs(unit.y) < 0.57 ? vec3(0, 1, 0) : vec3(0, 0, 1);
  return normalize(cross(unit, axis));
}

void main() {
  const uint d = gl_GlobalInvocationID.x;
  if (d >= num_draw_vertices) return;
  const DrawVertex vertex = draw_vertices[d];
  const vec3 centre = positions[vertex.solve_vertex].xyz;

  vec3 n = vec3(0), f1 = vec3(0), f2 = vec3(0);
  const uint end = group_corners[vertex.normal_group + 1];
  for (uint c = group_corners[vertex.normal_group]; c < end; ++c) {
    const Corner corner = corners[c];
    const vec3 e1 = (positions[corner.others.x].xyz - centre) * inverse_scale;
    const vec3 e2 = (positions[corner.others.y].xyz - centre) * inverse_scale;
    n += cross(e1, e2);
    f1 += corner.first.x * e1 + corner.first.y * e2;
    f2 += corner.second.x * e1 + corner.second.y * e2;
  }

  vec3 normal = vertex.normal;   // where no triangle has area: as authored
  if (IsDirection(n)) {
    n = normalize(n);
    vec3 t = f1 - n * dot(n, f1);
    t = IsDirection(t) ? normalize(t) : AnyPerpendicular(n);
    vec3 b = cross(n, t);
    vec2 turn = vec2(dot(f1, t) + dot(f2, b), dot(f1, b) - dot(f2, t));
    turn = dot(turn, turn) > LIMBER_SKIN_TINY ? normalize(turn) : vec2(1, 0);
    const vec3 t1 = turn.x * t + turn.y * b;
    const vec3 b1 = turn.x * b - turn.y * t;
    normal = normalize(t1 * vertex.normal.x + b1 * vertex.normal.y + n * vertex.normal.z);
  }
  vec3 tangent = f1 * vertex.tangent.x + f2 * vertex.tangent.y;
  tangent -= normal * dot(normal, tangent);
  tangent = IsDirection(tangent) ? normalize(tangent) : AnyPerpendicular(normal);

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
