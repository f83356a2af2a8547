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

struct Record {
  vec3 origin;
  uint unused;
  vec3 last_origin;
  uint last;
  uvec4 stream_first;
  uvec4 stream_step;
};

layout(std430, set = LIMBER_SKIN_SET_RIG, binding = LIMBER_SKIN_DRAW_VERTICES)
    readonly buffer DrawVertices { DrawVertex draw_vertices[]; };
layout(std430, set = LIMBER_SKIN_SET_RIG, binding = LIMBER_SKIN_GROUP_CORNERS)
    readonly buffer GroupCorners { uint group_corners[]; };
layout(std430, set = LIMBER_SKIN_SET_RIG, binding = LIMBER_SKIN_CORNERS)
    readonly buffer Corners { Corner corners[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_RECORDS)
    readonly buffer Records { Record records[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_SOLVE_POSITIONS)
    readonly buffer Positions { vec4 positions[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_LAST_POSITIONS)
    readonly buffer LastPositions { vec4 last_positions[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_STREAM_POSITIONS)
    writeonly buffer PositionStream { float position_stream[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_STREAM_NORMALS)
    writeonly buffer NormalStream { float normal_stream[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_STREAM_TANGENTS)
    writeonly buffer TangentStream { float tangent_stream[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_STREAM_LAST_POSITIONS)
    writeonly buffer LastPositionStream { float last_position_stream[]; };

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

Sums SumCorners(uint group, uint first, vec3 centre) {
  Sums sums = Sums(vec3(0), vec3(0), vec3(0));
  const uint end = group_corners[group + 1];
  for (uint c = group_corners[group]; c < end; ++c) {
    const Corner corner = corners[c];
    const vec3 e1 = (positions[first + corner.others.x].xyz - centre) * inverse_scale;
    const vec3 e2 = (positions[first + corner.others.y].xyz - centre) * inverse_scale;
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

void WriteFrame(DrawVertex vertex, Sums sums, uvec2 normal_at, uvec2 tangent_at) {
  vec3 normal = vertex.normal;   // where no triangle has area: as authored
  if (IsDirection(sums.n)) {
    normal = CarryNormal(vertex.normal, normalize(sums.n), sums.first, sums.second);
  }
  if (normal_at.y != 0) {
    normal_stream[normal_at.x] = normal.x;
    normal_stream[normal_at.x + 1] = normal.y;
    normal_stream[normal_at.x + 2] = normal.z;
  }
  if (tangent_at.y == 0) return;
  const vec3 tangent = OrthogonalDirection(
      sums.first * vertex.tangent.x + sums.second * vertex.tangent.y, normal);
  tangent_stream[tangent_at.x] = tangent.x;
  tangent_stream[tangent_at.x + 1] = tangent.y;
  tangent_stream[tangent_at.x + 2] = tangent.z;
  tangent_stream[tangent_at.x + 3] = vertex.tangent.z;
}

void main() {
  const uint d = gl_GlobalInvocationID.x;
  if (d >= num_draw_vertices) return;
  const uint instance = InstanceOfDispatch();
  const Record record = records[instance];
  const uint first_position = instance * num_solve_vertices;
  const DrawVertex vertex = draw_vertices[d];
  const vec3 centre = positions[first_position + vertex.solve_vertex].xyz;
  const uvec4 at = record.stream_first + d * record.stream_step;
  const uvec4 step = record.stream_step;

  if (step.y != 0 || step.z != 0) {
    WriteFrame(vertex, SumCorners(vertex.normal_group, first_position, centre),
               uvec2(at.y, step.y), uvec2(at.z, step.z));
  }
  const vec3 position = centre + record.origin;
  if (step.x != 0) {
    position_stream[at.x] = position.x;
    position_stream[at.x + 1] = position.y;
    position_stream[at.x + 2] = position.z;
  }
  if (step.w != 0) {
    vec3 last = position;
    if (record.last != LIMBER_SKIN_NO_LAST) {
      last = last_positions[record.last + vertex.solve_vertex].xyz + record.last_origin;
    }
    last_position_stream[at.w] = last.x;
    last_position_stream[at.w + 1] = last.y;
    last_position_stream[at.w + 2] = last.z;
  }
}
