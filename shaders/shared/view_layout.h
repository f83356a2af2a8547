// The one layout of the viewer's shaders, read by GLSL and by C++.
#ifndef LIMBER_SHADERS_SHARED_VIEW_LAYOUT_H_
#define LIMBER_SHADERS_SHARED_VIEW_LAYOUT_H_

// Set 0, once a frame.
#define LIMBER_VIEW_FRAME 0
#define LIMBER_VIEW_SHADOW_MAP 1
// Set 1, once a material.
#define LIMBER_VIEW_BASE_COLOR 0
#define LIMBER_VIEW_NORMAL_MAP 1

// Bits of DrawPush::flags.
#define LIMBER_VIEW_UNLIT 1u
#define LIMBER_VIEW_MASKED 2u
#define LIMBER_VIEW_CONTOURS 4u

// Bits of a handle dot's style.
#define LIMBER_VIEW_DOT_PINNED 1u
#define LIMBER_VIEW_DOT_HOVERED 2u
#define LIMBER_VIEW_DOT_GRABBED 4u

#ifdef __cplusplus
#include <cstdint>

namespace limber::shaders {

struct FrameUniforms {
  float clip_from_mesh[16];    // column-major
  float shadow_from_mesh[16];  // x and y to 0..1, z to depth
  float eye[4];                // mesh space; w: 1 for a flat (planar) character
  float key[4];                // towards the key light; w: width of the soft shadow, in the map
  float ground[4];             // where a shadow may fall: centre x, height, centre z, unused
  float ground_half[4];        // half its width in x and z, and the width of its soft border
  float viewport[4];           // width, height, dot radius in pixels, character's size
};

static_assert(sizeof(FrameUniforms) == 208);

struct DrawPush {
  float base_color[4];  // linear
  float roughness, metallic;
  float normal_scale;  // 0: no normal map
  float alpha_cutoff;
  uint32_t flags;
  float shading;  // 1: lit, 0: as bright as it is, whatever the light
};

static_assert(sizeof(DrawPush) == 40);

struct DotVertex {
  float position[3];  // mesh space
  uint32_t style;
};

static_assert(sizeof(DotVertex) == 16);

}  // namespace limber::shaders
#else

layout(std140, set = 0, binding = LIMBER_VIEW_FRAME) uniform Frame {
  mat4 clip_from_mesh;
  mat4 shadow_from_mesh;
  vec4 eye;
  vec4 key;
  vec4 ground;
  vec4 ground_half;
  vec4 viewport;
}

frame;

#endif

#endif  // LIMBER_SHADERS_SHARED_VIEW_LAYOUT_H_
