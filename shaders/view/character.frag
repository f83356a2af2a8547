// The character under studio light: a warm key with a soft shadow, a sky and a floor, a cool rim
// from behind. Diffuse light wraps around the terminator, red furthest, as it does in skin and
// clay; a broad highlight follows the material's roughness.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/view_layout.h"
#include "view/tone.glsl"
#include "view/shadow.glsl"

layout(set = 1, binding = LIMBER_VIEW_BASE_COLOR) uniform sampler2D base_color_map;
layout(set = 1, binding = LIMBER_VIEW_NORMAL_MAP) uniform sampler2D normal_map;

layout(push_constant) uniform Draw {
  vec4 base_color;
  float roughness;
  float metallic;
  float normal_scale;
  float alpha_cutoff;
  uint flags;
  float shading;
} draw;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_tangent;
layout(location = 3) centroid in vec2 texcoord;

layout(location = 0) out vec4 color;

vec3 ShadingNormal() {
  vec3 n = normalize(in_normal);
  if (draw.normal_scale != 0.0) {
    const vec3 t = normalize(in_tangent.xyz - n * dot(n, in_tangent.xyz));
    const vec3 b = cross(n, t) * in_tangent.w;
    vec3 detail = texture(normal_map, texcoord).xyz * 2.0 - 1.0;
    detail.xy *= draw.normal_scale;
    n = normalize(t * detail.x + b * detail.y + n * detail.z);
  }
  return gl_FrontFacing ? n : -n;
}

vec3 Environment(vec3 direction) {
  const vec3 sky = vec3(0.80, 0.87, 1.0), horizon = vec3(0.62, 0.61, 0.60);
  const vec3 floor_light = vec3(0.44, 0.39, 0.35);
  const float up = direction.y;
  return up > 0.0 ? mix(horizon, sky, smoothstep(0.0, 0.9, up))
                  : mix(horizon, floor_light, smoothstep(0.0, 0.7, -up));
}

// Lambert with the light reaching `wrap` past the terminator, the same energy for every wrap.
float Wrapped(float cosine, float wrap) {
  const float lit = max(0.0, (cosine + wrap) / (1.0 + wrap));
  return lit * lit / (1.0 + 0.4 * wrap) + (lit - lit * lit) * (1.0 - wrap);
}

float Highlight(vec3 n, vec3 l, vec3 v, float roughness) {
  const vec3 h = normalize(l + v);
  const float a = max(roughness * roughness, 0.02), a2 = a * a;
  const float nh = max(dot(n, h), 0.0), nv = max(dot(n, v), 1e-3), nl = max(dot(n, l), 0.0);
  const float d = nh * nh * (a2 - 1.0) + 1.0;
  const float visibility = 0.5 / mix(2.0 * nl * nv, nl + nv, a);   // Smith, approximated
  return a2 / (3.14159265 * d * d) * visibility * nl;
}

vec3 Shade(vec3 albedo, vec3 n) {
  const vec3 v = normalize(frame.eye.xyz - position), l = frame.key.xyz;
  const float nl = dot(n, l), nv = max(dot(n, v), 0.0);
  const float size = frame.viewport.w;
  const float bias = 0.004 + 0.004 * (1.0 - max(nl, 0.0));
  float through = 0.0;
  if (nl > -0.36) {   // else no key light arrives anyway
    through = LightThrough(position + n * (0.008 * size), frame.key.w, bias, 12);
  }
  const vec3 key_color = vec3(1.0, 0.945, 0.87) * 1.22;
  const vec3 wrapped = vec3(Wrapped(nl, 0.36), Wrapped(nl, 0.26), Wrapped(nl, 0.22));
  const vec3 soft = mix(vec3(through), vec3(1.0), vec3(0.10, 0.05, 0.04));

  const vec3 f0 = mix(vec3(0.04), albedo, draw.metallic);
  const vec3 diffuse = albedo * (1.0 - draw.metallic);
  const float facing = 1.0 - nv, grazing = facing * facing * facing * facing * facing;
  const vec3 fresnel = f0 + (max(vec3(1.0 - draw.roughness), f0) - f0) * grazing;

  vec3 light = diffuse * (Environment(n) * 0.42 + key_color * wrapped * soft);
  light += fresnel * Environment(reflect(-v, n)) * mix(0.85, 0.4, draw.roughness);
  light += f0 * key_color * 2.2 * Highlight(n, l, v, draw.roughness) * through;
  const vec3 back = normalize(vec3(0.62, 0.35, -0.70));
  const float rim = facing * facing * sqrt(facing) * smoothstep(-0.2, 0.7, dot(n, back));
  light += vec3(0.80, 0.90, 1.0) * rim * 0.55 * mix(vec3(0.35), vec3(1.0), albedo);
  return light;
}

// How much of a dark line lies here: about two pixels wide at each tenth of `value` between 0 and 1,
// and gone where they would be too close to be told apart.
float Contour(float value) {
  const float tenths = 10.0 * value, line = round(tenths);
  const float per_pixel = max(fwidth(tenths), 1e-6);
  if (line < 1.0 || line > 9.0) return 0.0;
  const float pixels = abs(tenths - line) / per_pixel;
  return (1.0 - smoothstep(0.4, 1.3, pixels)) * (1.0 - smoothstep(0.12, 0.35, per_pixel));
}

void main() {
  const vec4 base = draw.base_color * texture(base_color_map, texcoord);
  if ((draw.flags & LIMBER_VIEW_MASKED) != 0u && base.a < draw.alpha_cutoff) discard;
  vec3 light = base.rgb;
  if ((draw.flags & LIMBER_VIEW_CONTOURS) != 0u) light *= 1.0 - 0.55 * Contour(texcoord.x);
  if ((draw.flags & LIMBER_VIEW_UNLIT) == 0u) {
    light = mix(light, ToneMap(Shade(light, ShadingNormal())), draw.shading);
  }
  color = vec4(ToTarget(light, gl_FragCoord.xy), base.a);
}
