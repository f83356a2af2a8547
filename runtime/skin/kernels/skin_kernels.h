// The loops of skinning (eq. 6; normals and tangents), once for each instruction set; chosen when
// it runs.
//
// Lanes never meet and nothing is reordered: all instruction sets with a fused multiply-add give
// the same bits; the baseline of x86-64, which has none, gives its own (as in solve/kernels).
// Normals and tangents of given positions are the same in all: they use no fused ones.
#pragma once

#include <cstddef>
#include <cstdint>

namespace limber {

inline constexpr uint32_t kSkinLanes = 16;     // vertices of a block
inline constexpr uint32_t kMatrixFloats = 12;  // [3][4]

// A SkinLayout as kernels read it. Lanes past the last vertex are zero.
struct SkinBlocks {
  uint32_t num_vertices = 0, num_shapes = 0;
  const uint32_t* order = nullptr;         // [V] solve vertices
  const uint32_t* first_handle = nullptr;  // [blocks + 1] into handles
  const uint32_t* handles = nullptr;
  const float* weights = nullptr;         // [handles][lanes]
  const uint32_t* first_shape = nullptr;  // [blocks + 1] into shape_offsets
  // Of each block the shapes that are kept of it: floats from a handle's first matrix to that of
  // the shape.
  const uint32_t* shape_offsets = nullptr;
  const float* points = nullptr;  // [offsets][3][lanes]; of local shapes the difference to shape 0
};

// Floats of a SurfaceFrame and of a SkinDrawVertex.
inline constexpr uint32_t kFrameFloats = 16, kDrawVertexFloats = 8;

// Squared lengths below and above these are no direction (edges are about one unit at most). The
// bound above leaves room for every product that is taken of such vectors.
inline constexpr float kTinySquare = 1e-30f, kHugeSquare = 1e30f;

// A FrameLayout as kernels read it. Solve vertices as floats to their positions.
struct FrameBlocks {
  uint32_t num_groups = 0;
  float inverse_scale = 1;
  const uint32_t* order = nullptr;         // [blocks][lanes] groups; num_groups where there is none
  const uint32_t* centres = nullptr;       // [blocks][lanes]
  const uint32_t* first_corner = nullptr;  // [blocks + 1] into others and coefficients
  const uint32_t* others = nullptr;        // [corners][2][lanes]
  const float* coefficients = nullptr;     // [corners][4][lanes]
};

// Normals and directions of tangents of kSkinLanes draw vertices.
struct AppliedFrames {
  float numbers[6][kSkinLanes];
  int32_t usual[kSkinLanes];  // 0: those mean nothing
};

struct SkinKernels {
  const char* name;  // of the instruction set
  // out: [V][3] by solve vertex; origin: 3 floats, added last. matrices: [H][S][3][4], in the place
  // of shape 0 its sum with those of local shapes, and of all last columns, read there alone. For
  // each handle that a block follows 3 fused multiply-adds, and 9 for each of its shapes.
  void (*skin)(const SkinBlocks& blocks, const float* matrices, const float* origin, float* out);
  // frames: [G + 1] SurfaceFrame; positions: [V][3] and one float more that is read. Returns how
  // many frames are to be computed plainly, and in `unusual` which.
  size_t (*compute_frames)(const FrameBlocks& blocks, const float* positions, float* frames,
                           uint32_t* unusual);
  // vertices: kSkinLanes times SkinDrawVertex; groups: theirs.
  void (*apply_frames)(const float* frames, const float* vertices, const uint32_t* groups,
                       AppliedFrames* applied);
};

// The best that this machine has.
const SkinKernels& ChooseSkinKernels();

// Those that it has, null-terminated, narrowest first. For tests.
const SkinKernels* const* AvailableSkinKernels();

}  // namespace limber
