// The one layout of the skinning shaders, read by GLSL and by C++: bindings, group size, push
// constants, specialisation constants and the interleaved vertex that comes out.
//
// Pass 1 (skin_positions.comp), one invocation a solve vertex: eq. 6 of Wampler 2016.
// Pass 2 (skin_frames.comp), one invocation a draw vertex: gather, normal, tangent.
#ifndef LIMBER_SHADERS_SHARED_SKIN_LAYOUT_H_
#define LIMBER_SHADERS_SHARED_SKIN_LAYOUT_H_

#define LIMBER_SKIN_GROUP_SIZE 64

// Bindings of set 0.
#define LIMBER_SKIN_MATRICES 0         // [H][S][3] vec4, uniform (or storage where too large)
#define LIMBER_SKIN_WEIGHTS 1          // [H][V] float
#define LIMBER_SKIN_SHAPES 2           // [S][3][V] float: x, y and z planes, rig space
#define LIMBER_SKIN_SOLVE_POSITIONS 3  // [V] vec4, mesh units, origin not added
#define LIMBER_SKIN_DRAW_VERTICES 4    // [D] LimberSkinDrawVertex
#define LIMBER_SKIN_GROUP_CORNERS 5    // [G + 1] uint: first corner of each normal group
#define LIMBER_SKIN_CORNERS 6          // [C] LimberSkinCorner
#define LIMBER_SKIN_VERTICES 7         // [D][LIMBER_SKIN_VERTEX_FLOATS] float, the result
#define LIMBER_SKIN_NUM_BINDINGS 8

// Interleaved vertex: position (3), unit normal (3), unit tangent (3) and handedness (1).
#define LIMBER_SKIN_VERTEX_FLOATS 10

// Specialisation constants: loops of known length, and the array size of the uniform block.
#define LIMBER_SKIN_CONSTANT_HANDLES 0
#define LIMBER_SKIN_CONSTANT_SHAPES 1
#define LIMBER_SKIN_CONSTANT_ROWS 2

// Squared lengths below and above these are no direction. Edges are divided by the character's size
// first. The same bounds as in skin/skin_frames.cpp.
#define LIMBER_SKIN_TINY 1e-30
#define LIMBER_SKIN_HUGE 1e30

#ifdef __cplusplus
#include <cstdint>

namespace limber::shaders {

struct SkinPush {
  float origin[3];      // added to every position, last
  float inverse_scale;  // mesh units to rig units
  uint32_t num_solve_vertices;
  uint32_t num_draw_vertices;
};

static_assert(sizeof(SkinPush) == 24);

struct SkinDrawVertex {
  float normal[3];  // unit, in the frame (t, b, n) of its normal group
  uint32_t solve_vertex;
  float tangent[3];  // coefficients of the two pushed directions; third: handedness
  uint32_t normal_group;
};

static_assert(sizeof(SkinDrawVertex) == 32);

// A triangle seen from the vertex of its normal group: the other two corners, counter-clockwise,
// and the coefficients that write the group's two tangent directions in its edges.
struct SkinCorner {
  uint32_t a, b;
  float first[2], second[2];
};

static_assert(sizeof(SkinCorner) == 24);

}  // namespace limber::shaders
#endif

#endif  // LIMBER_SHADERS_SHARED_SKIN_LAYOUT_H_
