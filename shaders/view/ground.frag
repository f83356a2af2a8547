// The floor itself is invisible; only the shadow on it shows, softer the further it falls.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"
#include "view/tone.glsl"
#include "view/shadow.glsl"

layout(location = 0) in vec3 position;
layout(location = 0) out vec4 color;

void main() {
  const vec2 inside = frame.ground_half.xy - abs(position.xz - frame.ground.xz);
  const vec2 border = smoothstep(vec2(0.0), frame.ground_half.zz, inside);
  const float fade = border.x * border.y;
  if (fade <= 0.0 || frame.eye.y < frame.ground.y) discard;
  const float wide = LightThrough(position, 4.0 * frame.key.w, 0.002, 24);
  if (wide == 1.0) discard;
  const float close = LightThrough(position, 1.5 * frame.key.w, 0.002, 16);
  const float shadow = 1.0 - mix(wide, close, 0.4);
  color = vec4(ToTarget(vec3(0.10, 0.085, 0.08), gl_FragCoord.xy), 0.55 * shadow * fade);
}
