// Soft lookup in the key light's depth map: the part of the light that arrives, 0..1.
layout(set = 0, binding = LIMBER_VIEW_SHADOW_MAP) uniform sampler2DShadow shadow_map;

// `count` points of a Vogel spiral (each a golden angle further, radius by the square root) cover a
// disc evenly; a start angle by pixel blurs the rings of a few samples into a smooth edge. Where
// the centre and two rings of four agree, the rest is taken to agree too.
float LightThrough(vec3 mesh_position, float softness, float bias, int count) {
  const vec4 p = frame.shadow_from_mesh * vec4(mesh_position, 1);
  if (any(lessThan(p.xyz, vec3(0))) || any(greaterThan(p.xyz, vec3(1)))) return 1.0;
  const float depth = p.z - bias;
  const float start = 6.2831853 * PixelNoise(gl_FragCoord.xy);
  vec2 along = vec2(cos(start), sin(start));

  float probe = textureLod(shadow_map, vec3(p.xy, depth), 0.0);
  const vec2 rim = along * softness, half_way = 0.36 * vec2(rim.x - rim.y, rim.x + rim.y);
  for (int i = 0; i < 2; ++i) {
    const vec2 d = i == 0 ? rim : half_way, turned = vec2(-d.y, d.x);
    probe += textureLod(shadow_map, vec3(p.xy + d, depth), 0.0);
    probe += textureLod(shadow_map, vec3(p.xy - d, depth), 0.0);
    probe += textureLod(shadow_map, vec3(p.xy + turned, depth), 0.0);
    probe += textureLod(shadow_map, vec3(p.xy - turned, depth), 0.0);
  }
  if (probe == 0.0 || probe == 9.0) return probe / 9.0;

  const mat2 kGoldenTurn = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
  float light = 0.0;
  for (int i = 0; i < count; ++i) {
    const float radius = softness * sqrt((float(i) + 0.5) / float(count));
    light += textureLod(shadow_map, vec3(p.xy + radius * along, depth), 0.0);
    along = kGoldenTurn * along;
  }
  return light / float(count);
}
