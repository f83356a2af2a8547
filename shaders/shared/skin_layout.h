// The one layout of the skinning shaders, read by GLSL and by C++: bindings, group size, push
// constants, specialisation constants and records.
//
// Pass 1 (skin_positions.comp), one invocation a solve vertex: eq. 6 of Wampler 2016.
// Pass 2 (skin_vertices.comp), one invocation a draw vertex: gather, normal, tangent.
// Both take all instances of one rig in one dispatch: x counts vertices, y instances.
#ifndef LIMBER_SHADERS_SHARED_SKIN_LAYOUT_H_
#define LIMBER_SHADERS_SHARED_SKIN_LAYOUT_H_

#define LIMBER_SKIN_GROUP_SIZE 64

// Set 0: a rig's tables.
#define LIMBER_SKIN_SET_RIG 0
#define LIMBER_SKIN_WEIGHTS 0        // [H][V] float
#define LIMBER_SKIN_SHAPES 1         // [S][3][V] float: x, y and z planes, rig space
#define LIMBER_SKIN_DRAW_VERTICES 2  // [D] SkinDrawVertex
#define LIMBER_SKIN_GROUP_CORNERS 3  // [G + 1] uint: first corner of each normal group
#define LIMBER_SKIN_CORNERS 4        // [C] SkinCorner
#define LIMBER_SKIN_NUM_RIG_BINDINGS 5

// Set 1: of the instances in one dispatch.
#define LIMBER_SKIN_SET_BATCH 1
#define LIMBER_SKIN_MATRICES 0         // [instance][H][S][3] vec4
#define LIMBER_SKIN_RECORDS 1          // [instance] SkinRecord
#define LIMBER_SKIN_SOLVE_POSITIONS 2  // [instance][V] vec4, mesh units, origin not added
#define LIMBER_SKIN_LAST_POSITIONS 3   // those of all instances in the frame before
// Where the vertices go, in the host's own layout.
#define LIMBER_SKIN_FIRST_STREAM 4
#define LIMBER_SKIN_STREAM_POSITIONS 4       // 3 floats
#define LIMBER_SKIN_STREAM_NORMALS 5         // 3 floats, unit
#define LIMBER_SKIN_STREAM_TANGENTS 6        // 4 floats, unit and handedness
#define LIMBER_SKIN_STREAM_LAST_POSITIONS 7  // 3 floats
#define LIMBER_SKIN_NUM_STREAMS 4
#define LIMBER_SKIN_NUM_BATCH_BINDINGS 8

// Specialisation constants.
#define LIMBER_SKIN_CONSTANT_HANDLES 0
#define LIMBER_SKIN_CONSTANT_SHAPES 1
// 1: the loops over handles and shapes are laid out.
#define LIMBER_SKIN_CONSTANT_UNROLLED 2
// 1: y counts instances; 0: there is one, so that every matrix has a known address.
#define LIMBER_SKIN_CONSTANT_MANY 3
// Shapes whose positions stay in registers.
#define LIMBER_SKIN_CONSTANT_KEPT 4

// SkinRecord::last where there is no frame before.
#define LIMBER_SKIN_NO_LAST 0xFFFFFFFFu

// Squared lengths below and above these are no direction. Edges are divided by the character's size
// first. The same bounds as in skin/skin_frames.cpp.
#define LIMBER_SKIN_TINY 1e-30
#define LIMBER_SKIN_HUGE 1e30

#ifdef __cplusplus
#include <cstdint>

namespace limber::shaders {

// One dispatch.
struct SkinPush {
  uint32_t num_solve_vertices, num_draw_vertices;
  float inverse_scale;  // mesh units to rig units
};

static_assert(sizeof(SkinPush) == 12);

// One instance.
struct SkinRecord {
  float origin[3];  // added to every position, last
  uint32_t unused;
  float last_origin[3];
  uint32_t last;             // the first of last frame's, or LIMBER_SKIN_NO_LAST
  uint32_t stream_first[4];  // in floats from where the stream is bound
  uint32_t stream_step[4];   // floats from vertex to vertex; 0: not wanted
};

static_assert(sizeof(SkinRecord) == 64);

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
#else

layout(constant_id = LIMBER_SKIN_CONSTANT_MANY) const bool kMany = true;

layout(push_constant) uniform Push {
  uint num_solve_vertices;
  uint num_draw_vertices;
  float inverse_scale;
};

uint InstanceOfDispatch() {
  return kMany ? gl_WorkGroupID.y : 0;
}

#endif

#endif  // LIMBER_SHADERS_SHARED_SKIN_LAYOUT_H_
