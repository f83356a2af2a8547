// Soft lookup in the key light's depth map: the part of the light that arrives, 0..1.
layout(set = 0, binding = LIMBER_VIEW_SHADOW_MAP) uniform sampler2DShadow shadow_map;

// Points of a Vogel spiral: even cover of a disc. Turned by a per-pixel angle, so that the rings of
// a few samples blur into a smooth edge.
float LightThrough(vec3 mesh_position, float softness, float bias, vec2 pixel) {
  const vec4 p = frame.shadow_from_mesh * vec4(mesh_position, 1);
  if (any(lessThan(p.xyz, vec3(0))) || any(greaterThan(p.xyz, vec3(1)))) return 1.0;
  const int kSamples = 16;
  const float turn = 6.2831853 * fract(52.9829189 * fract(dot(floor(pixel),
                                                             vec2(0.06711056, 0.00583715))));
  float light = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const float radius = softness * sqrt((float(i) + 0.5) / float(kSamples));
    const float angle = turn + 2.3999632 * float(i);
    const vec2 offset = radius * vec2(cos(angle), sin(angle));
    light += textureLod(shadow_map, vec3(p.xy + offset, p.z - bias), 0.0);
  }
  return light / float(kSamples);
}
