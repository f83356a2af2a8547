// Pass 1: eq. 6 of Wampler 2016 for every solve vertex,
//   q_p = sum_h W_hp sum_s A_hs [P_sp; 1]     (the origin is added in pass 2).
//
// One invocation a vertex. For each handle the inner sum y_h costs 9 S fused multiply-adds and the
// weighting 3 more: 9 H S + 3 H in all (513 for H = 9, S = 6), because the host has summed the
// translations over the shapes into shape 0. Matrices are uniform over a work group: scalar loads.
// What a vertex reads is coalesced: H weights and 3 S coordinates.
//
// Up to some size (vulkan_pipelines.cpp) the loops are laid out and a vertex's coordinates stay in
// registers. Beyond it handles are taken in blocks of four, so that one load of a coordinate feeds
// twelve multiply-adds.
//
// Handles (or blocks of them) whose weights vanish are skipped: neighbours in a buffer are mostly
// neighbours on the surface, so whole subgroups skip together. A device that is a CPU runs its lanes
// in step and loses its scalar loads to any branch: there (kMany is false) nothing is skipped, and
// lanes beyond the last vertex do its work again.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/skin_layout.h"

layout(local_size_x = LIMBER_SKIN_GROUP_SIZE) in;

layout(constant_id = LIMBER_SKIN_CONSTANT_HANDLES) const uint kNumHandles = 1;
layout(constant_id = LIMBER_SKIN_CONSTANT_SHAPES) const uint kNumShapes = 1;
layout(constant_id = LIMBER_SKIN_CONSTANT_UNROLLED) const bool kUnrolled = false;
layout(constant_id = LIMBER_SKIN_CONSTANT_KEPT) const uint kNumKept = 1;  // S, or 1 if not unrolled

layout(std430, set = LIMBER_SKIN_SET_RIG, binding = LIMBER_SKIN_WEIGHTS)
    readonly buffer Weights { float weights[]; };
layout(std430, set = LIMBER_SKIN_SET_RIG, binding = LIMBER_SKIN_SHAPES)
    readonly buffer Shapes { float shapes[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_MATRICES)
    readonly buffer Matrices { vec4 rows[]; };
layout(std430, set = LIMBER_SKIN_SET_BATCH, binding = LIMBER_SKIN_SOLVE_POSITIONS)
    writeonly buffer Positions { vec4 positions[]; };

vec3 Transform(uint row, vec3 p, vec3 sum) {
  const vec3 x = rows[row].xyz, y = rows[row + 1].xyz, z = rows[row + 2].xyz;
  return vec3(fma(x.x, p.x, fma(x.y, p.y, fma(x.z, p.z, sum.x))),
              fma(y.x, p.x, fma(y.y, p.y, fma(y.z, p.z, sum.y))),
              fma(z.x, p.x, fma(z.y, p.y, fma(z.z, p.z, sum.z))));
}

vec3 Translation(uint row) { return vec3(rows[row].w, rows[row + 1].w, rows[row + 2].w); }

vec3 ShapePosition(uint shape, uint v) {
  const uint plane = shape * 3 * num_solve_vertices + v;
  return vec3(shapes[plane], shapes[plane + num_solve_vertices],
              shapes[plane + 2 * num_solve_vertices]);
}

vec3 SkinUnrolled(uint first_row, uint v) {
  vec3 p[kNumKept];
  [[unroll]] for (uint s = 0; s < kNumKept; ++s) p[s] = ShapePosition(s, v);
  vec3 q = vec3(0);
  [[unroll]] for (uint h = 0; h < kNumHandles; ++h) {
    const float w = weights[h * num_solve_vertices + v];
    if (kMany && w == 0) continue;
    const uint row = first_row + h * (kNumKept * 3);
    vec3 y = Translation(row);
    [[unroll]] for (uint s = 0; s < kNumKept; ++s) y = Transform(row + 3 * s, p[s], y);
    q += w * y;
  }
  return q;
}

// Four handles.
vec3 SkinBlock(uint first_handle, uint first_row, uint v) {
  vec4 w = vec4(0);
  uint row[4];
  vec3 y[4];
  for (uint i = 0; i < 4; ++i) {
    const uint h = min(first_handle + i, kNumHandles - 1);
    row[i] = first_row + h * (kNumShapes * 3);
    if (first_handle + i < kNumHandles) w[i] = weights[h * num_solve_vertices + v];
  }
  if (kMany && w == vec4(0)) return vec3(0);
  for (uint i = 0; i < 4; ++i) y[i] = Translation(row[i]);
  [[dont_unroll]] for (uint s = 0; s < kNumShapes; ++s) {
    const vec3 p = ShapePosition(s, v);
    for (uint i = 0; i < 4; ++i) y[i] = Transform(row[i] + 3 * s, p, y[i]);
  }
  return w.x * y[0] + w.y * y[1] + w.z * y[2] + w.w * y[3];
}

void main() {
  const uint v = min(gl_GlobalInvocationID.x, num_solve_vertices - 1);
  const uint instance = InstanceOfDispatch();
  const uint row = instance * (kNumHandles * kNumShapes * 3);
  vec3 q = vec3(0);
  if (kUnrolled) {
    q = SkinUnrolled(row, v);
  } else {
    [[dont_unroll]] for (uint h = 0; h < kNumHandles; h += 4) q += SkinBlock(h, row, v);
  }
  if (gl_GlobalInvocationID.x == v) positions[instance * num_solve_vertices + v] = vec4(q, 1);
}
