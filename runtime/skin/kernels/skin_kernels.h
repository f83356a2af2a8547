// The loop of skinning (eq. 6), once for each instruction set; chosen when it runs.
//
// Lanes never meet and nothing is reordered: all instruction sets with a fused multiply-add give
// the same bits; the baseline of x86-64, which has none, gives its own (as in solve/kernels).
#pragma once

#include <cstdint>

namespace limber {

inline constexpr uint32_t kSkinLanes = 16;  // vertices of a block

// A SkinLayout as kernels read it.
struct SkinBlocks {
  uint32_t num_vertices = 0, num_shapes = 0;
  const uint32_t* order = nullptr;         // [V] solve vertices
  const uint32_t* first_handle = nullptr;  // [blocks + 1]
  const uint32_t* handles = nullptr;
  const float* weights = nullptr;  // [handles][lanes]
  const float* shapes = nullptr;   // [blocks][S][3][lanes]; lanes past the last vertex are zero
};

struct SkinKernels {
  const char* name;  // of the instruction set
  // out: [V][3] by solve vertex; origin: 3 floats, added last. matrices: [H][S][3][4];
  // translations: [H][4], their last columns summed over the shapes, so that no step adds one. For
  // each handle that a block follows 9 S fused multiply-adds and 3.
  void (*skin)(const SkinBlocks& blocks, const float* matrices, const float* translations,
               const float* origin, float* out);
};

// The best that this machine has.
const SkinKernels& ChooseSkinKernels();

// Those that it has, null-terminated, narrowest first. For tests.
const SkinKernels* const* AvailableSkinKernels();

}  // namespace limber
