// Pass 1: eq. 6 of Wampler 2016 for every solve vertex,
//   q_p = sum_h W_hp sum_s A_hs [P_sp; 1]     (the origin is added in pass 2).
//
// Dense, one invocation a vertex. For each handle the inner sum y_h costs 9 S fused multiply-adds
// and the weighting 3 more: 9 H S + 3 H in all (513 for H = 9, S = 6), because the host has summed
// the translations over the shapes into shape 0. Handles are taken in blocks of four, so that one
// load of a shape position (three coalesced floats) feeds 36 multiply-adds, and a block is skipped
// where its four weights vanish: neighbours in a buffer are mostly neighbours on the surface, so
// whole subgroups skip together. Matrices are uniform over the dispatch: scalar loads.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/skin_layout.h"

layout(local_size_x = LIMBER_SKIN_GROUP_SIZE) in;

layout(constant_id = LIMBER_SKIN_CONSTANT_HANDLES) const uint kNumHandles = 1;
layout(constant_id = LIMBER_SKIN_CONSTANT_SHAPES) const uint kNumShapes = 1;
layout(constant_id = LIMBER_SKIN_CONSTANT_ROWS) const uint kNumRows = 3;

#ifdef LIMBER_MATRICES_IN_STORAGE
layout(std430, binding = LIMBER_SKIN_MATRICES) readonly buffer Matrices { vec4 rows[]; };
#else
layout(std140, binding = LIMBER_SKIN_MATRICES) uniform Matrices { vec4 rows[kNumRows]; };
#endif
layout(std430, binding = LIMBER_SKIN_WEIGHTS) readonly buffer Weights { float weights[]; };
layout(std430, binding = LIMBER_SKIN_SHAPES) readonly buffer Shapes { float shapes[]; };
layout(std430, binding = LIMBER_SKIN_SOLVE_POSITIONS) writeonly buffer Positions {
  vec4 positions[];
};

layout(push_constant) uniform Push {
  vec3 origin;
  float inverse_scale;
  uint num_solve_vertices;
  uint num_draw_vertices;
};

vec3 Transform(uint row, vec3 p, vec3 sum) {
  const vec3 x = rows[row].xyz, y = rows[row + 1].xyz, z = rows[row + 2].xyz;
  return vec3(fma(x.x, p.x, fma(x.y, p.y, fma(x.z, p.z, sum.x))),
              fma(y.x, p.x, fma(y.y, p.y, fma(y.z, p.z, sum.y))),
              fma(z.x, p.x, fma(z.y, p.y, fma(z.z, p.z, sum.z))));
}

vec3 Translation(uint row) { return vec3(rows[row].w, rows[row + 1].w, rows[row + 2].w); }

void main() {
  const uint v = gl_GlobalInvocationID.x;
  const uint count = num_solve_vertices;
  if (v >= count) return;

  vec3 q = vec3(0);
  for (uint block = 0; block < kNumHandles; block += 4) {
    vec4 w = vec4(0);
    uint row[4];
    for (uint i = 0; i < 4; ++i) {
      const uint h = min(block + i, kNumHandles - 1);
      row[i] = h * kNumShapes * 3;
      if (block + i < kNumHandles) w[i] = weights[h * count + v];
    }
    if (w == vec4(0)) continue;
    vec3 y0 = Translation(row[0]), y1 = Translation(row[1]);
    vec3 y2 = Translation(row[2]), y3 = Translation(row[3]);
    for (uint s = 0; s < kNumShapes; ++s) {
      const uint plane = s * 3 * count + v;
      const vec3 p = vec3(shapes[plane], shapes[plane + count], shapes[plane + 2 * count]);
      y0 = Transform(row[0] + 3 * s, p, y0);
      y1 = Transform(row[1] + 3 * s, p, y1);
      y2 = Transform(row[2] + 3 * s, p, y2);
      y3 = Transform(row[3] + 3 * s, p, y3);
    }
    q += w.x * y0 + w.y * y1 + w.z * y2 + w.w * y3;
  }
  positions[v] = vec4(q, 1);
}
