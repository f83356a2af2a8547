#version 330 core
#include <shading.glsl>

in vec3 at;
in vec4 shadow_place;

uniform mat4 world;
uniform vec4 key_position;
uniform sampler2D shadows;

out vec4 result;

// A pool of light that melts into the backdrop.
void main() {
  vec3 from_centre = (at - world[3].xyz) / length(world[0].xyz);
  float pool = 1.0 - smoothstep(0.1, 1.0, length(from_centre));
  float lit = Lit(shadows, shadow_place, 2.2, 0.0);  // casts none itself: no bias, no gap at feet
  vec3 light = vec3(0.66, 0.63, 0.585) * mix(vec3(0.36, 0.375, 0.43), vec3(1.0), lit);
  result = vec4(ToScreen(light), pool);
}
