// Depth as the key light sees it.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"

layout(location = 0) in vec3 position;

void main() {
  vec4 p = frame.shadow_from_mesh * vec4(position, 1.0);
  p.xy = 2.0 * p.xy - 1.0;
  gl_Position = p;
}
