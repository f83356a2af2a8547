// The loop of skinning (eq. 6), once for each instruction set; chosen when it runs.
//
// Lanes never meet and nothing is reordered: all instruction sets with a fused multiply-add give
// the same bits; the baseline of x86-64, which has none, gives its own (as in solve/kernels).
#pragma once

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

struct SkinKernels {
  const char* name;  // of the instruction set
  // out: [V][3] by solve vertex; origin: 3 floats, added last. matrices: [H][S][3][4], in the place
  // of shape 0 its sum with those of local shapes, and of all last columns, read there alone. For
  // each handle that a block follows 3 fused multiply-adds, and 9 for each of its shapes.
  void (*skin)(const SkinBlocks& blocks, const float* matrices, const float* origin, float* out);
};

// The best that this machine has.
const SkinKernels& ChooseSkinKernels();

// Those that it has, null-terminated, narrowest first. For tests.
const SkinKernels* const* AvailableSkinKernels();

}  // namespace limber
