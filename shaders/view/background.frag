// A studio backdrop: light behind the character, darker to the corners, cooler above than below.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"
#include "view/tone.glsl"

layout(location = 0) in vec2 place;
layout(location = 0) out vec4 color;

void main() {
  const float aspect = frame.viewport.x / max(frame.viewport.y, 1.0);
  const vec2 p = (place - vec2(0.5, 0.46)) * vec2(aspect, 1.0);
  const float away = smoothstep(0.0, 1.15, length(p * vec2(0.8, 1.0)));
  const vec3 above = vec3(0.66, 0.70, 0.745), below = vec3(0.70, 0.675, 0.645);
  const vec3 tint = mix(above, below, smoothstep(0.1, 0.95, place.y));
  color = vec4(ToTarget(tint * mix(1.06, 0.58, away), gl_FragCoord.xy), 1.0);
}
