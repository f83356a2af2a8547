// The piece of the floor that catches the shadow.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"

layout(location = 0) out vec3 position;

void main() {
  const vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
  position = vec3(frame.ground.x + corner.x * frame.ground_half.x, frame.ground.y,
                  frame.ground.z + corner.y * frame.ground_half.y);
  gl_Position = frame.clip_from_mesh * vec4(position, 1.0);
}
