#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec2 texcoord;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_tangent;
// Where a pixel's centre lies off the triangle, what is interpolated there would be beyond the
// picture's edge, and wrap around.
layout(location = 3) centroid out vec2 out_texcoord;

void main() {
  out_position = position;
  out_normal = normal;
  out_tangent = tangent;
  out_texcoord = texcoord;
  gl_Position = frame.clip_from_mesh * vec4(position, 1.0);
}
