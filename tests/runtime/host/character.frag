// A warm key light, a cool sky, and a glow where the motion vectors are long.
#version 450

layout(location = 0) in vec3 world_normal;
layout(location = 1) in vec3 world_position;
layout(location = 2) in float speed;

layout(push_constant) uniform Push {
  mat4 clip_from_world;
  vec4 place;
  vec4 colour;
  vec4 turn;
};

layout(location = 0) out vec4 result;

void main() {
  const vec3 facing = normalize(world_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  const float key = max(dot(facing, normalize(vec3(0.5, 0.8, 0.6))), 0);
  const float sky = 0.5 + 0.5 * facing.y;
  const vec3 light = key * vec3(1.0, 0.9, 0.75) + mix(vec3(0.10, 0.09, 0.08), vec3(0.22, 0.28, 0.38), sky);
  const float ground_shade = smoothstep(-0.1, 0.5, world_position.y) * 0.4 + 0.6;
  const vec3 glow = min(speed * 0.25, 0.35) * vec3(1.0, 0.35, 0.1);
  result = vec4(colour.rgb * light * ground_shade + glow, 1);
}
