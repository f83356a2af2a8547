#version 330 core

in vec4 vertex;

uniform mat4 world_view_proj;

out vec2 depth;

void main() {
  gl_Position = world_view_proj * vertex;
  depth = gl_Position.zw;
}
