#version 330 core
#include <shading.glsl>

in vec3 at;
in vec3 normal_world;
in vec2 uv;
in vec4 shadow_place;

uniform sampler2D colours;
uniform sampler2D shadows;
uniform vec3 camera;
uniform vec4 key_position;
uniform vec4 key_colour;
uniform vec4 rim_position;
uniform vec4 rim_colour;
uniform float roughness;
uniform float upright;

out vec4 result;

float Shine(vec3 normal, vec3 light, vec3 view) {
  float power = 2.0 / pow(roughness, 4.0);
  float lobe = pow(max(dot(normal, normalize(light + view)), 0.0), power);
  return 0.04 * lobe * (power + 2.0) / 8.0;
}

void main() {
  vec4 texel = texture(colours, uv);
  float cut = clamp((texel.a - 0.5) / max(fwidth(texel.a), 1e-3) + 0.5, 0.0, 1.0);
  if (cut < 0.05) discard;
  vec3 base = ToLinear(texel.rgb);
  // OGRE draws into textures upside down, which turns front faces into back faces.
  bool front = gl_FrontFacing == (upright > 0.0);
  vec3 normal = normalize(front ? normal_world : -normal_world);
  vec3 view = normalize(camera - at);
  vec3 key = normalize(key_position.xyz - at);
  vec3 rim = normalize(rim_position.xyz);

  float facing = dot(normal, key);
  float lit = Lit(shadows, shadow_place, 1.6, 0.004 + 0.02 * (1.0 - max(facing, 0.0)));
  float diffuse = max(facing, 0.0) * lit;
  vec3 sky = mix(vec3(0.30, 0.25, 0.22), vec3(0.42, 0.48, 0.60), 0.5 + 0.5 * normal.y);
  vec3 light = base * (sky * 0.7 + key_colour.rgb * diffuse * 1.2);
  light += key_colour.rgb * Shine(normal, key, view) * max(facing, 0.0) * lit;
  float edge = pow(1.0 - max(dot(normal, view), 0.0), 3.0);
  light += rim_colour.rgb * max(dot(normal, rim), 0.0) * (0.5 * base + 0.5 * edge);
  result = vec4(ToScreen(light), cut);  // alpha to coverage, where it is on
}
