// A studio backdrop: light behind the character, darker to the corners, cooler above than below.
// Colours are sRGB codes: nothing is lit here.
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
  const vec3 above = vec3(0.832, 0.853, 0.876), below = vec3(0.852, 0.838, 0.821);
  const vec3 tint = mix(above, below, smoothstep(0.1, 0.95, place.y));
  color = vec4(Dithered(tint * mix(1.025, 0.79, away), gl_FragCoord.xy), 1.0);
}
