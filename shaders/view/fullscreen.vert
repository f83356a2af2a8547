// One triangle that covers the target; `place` runs from (0, 0) at the top left to (1, 1).
#version 450

layout(location = 0) out vec2 place;

void main() {
  place = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
  gl_Position = vec4(2.0 * place - 1.0, 1.0, 1.0);
}
