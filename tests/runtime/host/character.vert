// A character of the host's crowd: its skin stands somewhere in the world.
#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 last_position;

layout(push_constant) uniform Push {
  mat4 clip_from_world;
  vec4 place;   // xyz, and the size of a mesh unit
  vec4 colour;  // linear; a: cosine of the turn about y
  vec4 turn;    // x: its sine; y: how many frames a second
};

layout(location = 0) out vec3 world_normal;
layout(location = 1) out vec3 world_position;
layout(location = 2) out float speed;

vec3 Turned(vec3 v) {
  return vec3(colour.a * v.x + turn.x * v.z, v.y, colour.a * v.z - turn.x * v.x);
}

void main() {
  world_position = place.xyz + place.w * Turned(position);
  world_normal = Turned(normal);
  speed = place.w * length(position - last_position) * turn.y;
  gl_Position = clip_from_world * vec4(world_position, 1);
}
