#version 330 core

in vec2 depth;
out vec4 result;

void main() { result = vec4(depth.x / depth.y, 0.0, 0.0, 1.0); }
