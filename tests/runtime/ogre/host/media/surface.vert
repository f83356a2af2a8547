#version 330 core

in vec4 vertex;
in vec3 normal;
in vec2 uv0;

uniform mat4 world;
uniform mat4 world_view_proj;
uniform mat4 to_shadow;

out vec3 at;
out vec3 normal_world;
out vec2 uv;
out vec4 shadow_place;

void main() {
  vec4 place = world * vertex;
  at = place.xyz;
  normal_world = mat3(world) * normal;
  uv = uv0;
  shadow_place = to_shadow * place;
  gl_Position = world_view_proj * vertex;
}
