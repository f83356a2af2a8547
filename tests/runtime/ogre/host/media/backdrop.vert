#version 330 core

in vec4 vertex;
in vec2 uv0;
out vec2 uv;

void main() {
  gl_Position = vec4(vertex.xy, 0.0, 1.0);
  uv = uv0;
}
