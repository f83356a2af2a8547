// Handle dots: one instanced square each, of constant size on the screen.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"

layout(location = 0) in vec3 position;
layout(location = 1) in uint style;

layout(location = 0) out vec2 out_offset;          // in dot radii
layout(location = 1) flat out uint out_style;

void main() {
  const float kReach = 2.4;   // the halo and the soft shadow need room
  const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
  out_offset = corner * kReach;
  out_style = style;
  gl_Position = frame.clip_from_mesh * vec4(position, 1.0);
  gl_Position.xy += corner * kReach * frame.viewport.z * 2.0 / frame.viewport.xy * gl_Position.w;
  gl_Position.z = 0.0;   // on top of everything, never clipped by the near plane
}
