// Pinned handles are filled, free ones are rings; a hovered or grabbed one has a halo.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"
#include "view/tone.glsl"

layout(location = 0) in vec2 offset;
layout(location = 1) flat in uint style;

layout(location = 0) out vec4 color;

// 1 inside, 0 outside, a pixel wide in between.
float Inside(float distance_to_edge) {
  return clamp(0.5 - distance_to_edge * frame.viewport.z, 0.0, 1.0);
}

void Over(inout vec4 below, vec3 paint, float alpha) {
  below.rgb = mix(below.rgb * below.a, paint, alpha) ;
  below.a = alpha + below.a * (1.0 - alpha);
  below.rgb = below.a > 0.0 ? below.rgb / below.a : paint;
}

void main() {
  const bool pinned = (style & LIMBER_VIEW_DOT_PINNED) != 0u;
  const bool hovered = (style & LIMBER_VIEW_DOT_HOVERED) != 0u;
  const bool grabbed = (style & LIMBER_VIEW_DOT_GRABBED) != 0u;
  const float r = length(offset);
  const vec3 accent = grabbed ? vec3(1.0, 0.62, 0.10) : vec3(0.94, 0.22, 0.09);
  const vec3 white = vec3(1.0);

  vec4 paint = vec4(0.0);
  const float hole = pinned ? 1.0 : 1.0 - Inside(r - 0.52);
  const float fall = length(offset - vec2(0.0, 0.22));
  Over(paint, vec3(0.05, 0.04, 0.04), 0.45 * hole * (1.0 - smoothstep(0.75, 1.55, fall)));
  if (hovered || grabbed) {
    Over(paint, accent, 0.42 * Inside(r - 1.95));
  }
  if (pinned) {
    Over(paint, white, Inside(r - 1.0));
    Over(paint, accent, Inside(r - 0.70));
  } else {
    const float ring = Inside(r - 1.0) * (1.0 - Inside(r - 0.52));
    Over(paint, white, ring);
    Over(paint, accent, Inside(abs(r - 0.76) - 0.11));
  }
  color = vec4(ToTarget(paint.rgb, gl_FragCoord.xy), paint.a);
}
