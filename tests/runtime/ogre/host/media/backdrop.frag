#version 330 core
#include <shading.glsl>

in vec2 uv;
out vec4 result;

void main() {
  float away = length((uv - vec2(0.5, 0.62)) * vec2(1.0, 1.2));
  vec3 light = mix(vec3(0.52, 0.53, 0.54), vec3(0.20, 0.235, 0.29), smoothstep(0.0, 0.9, away));
  result = vec4(ToScreen(light), 1.0);
}
