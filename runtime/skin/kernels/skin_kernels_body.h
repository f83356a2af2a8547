// The body of skin_kernels.h, for one instruction set: LIMBER_KERNEL_NAMESPACE names it.
// See skin_lanes.h.
#pragma once

#include "skin/kernels/skin_lanes.h"

namespace limber::LIMBER_KERNEL_NAMESPACE {

#if defined(__AVX512F__)
constexpr size_t kMostHandles = 4;
#else
constexpr size_t kMostHandles = 3;
#endif

struct Point {
  Lanes axis[3];
};

// y += the matrix's linear part times p. Matrices are broadcast straight from memory.
static inline __attribute__((always_inline)) void AddLinear(const float* matrix, const Point& p,
                                                            Point* y) {
  for (size_t row = 0; row < 3; ++row) {
    Lanes sum = MulAdd(Splat(matrix[row * 4 + 2]), p.axis[2], y->axis[row]);
    sum = MulAdd(Splat(matrix[row * 4 + 1]), p.axis[1], sum);
    y->axis[row] = MulAdd(Splat(matrix[row * 4]), p.axis[0], sum);
  }
}

// What kWidth vertices of a block need.
struct Piece {
  const float* matrices;
  const float* weights;  // of the piece's first lane; points likewise
  const float* points;
  const uint32_t* handles;
  const uint32_t* shape_offsets;
  size_t num_block_shapes;
  size_t num_shapes;  // of the character
};

static inline __attribute__((always_inline)) Point LoadPoint(const float* from) {
  Point p;
  for (size_t axis = 0; axis < 3; ++axis)
    p.axis[axis] = Load(from + axis * kLanes);
  return p;
}

// q += the next N handles' part. A shape's positions are loaded once for all of them, and their
// sums are chains enough to keep the multipliers busy.
template <size_t N>
static inline __attribute__((always_inline)) void AddHandles(const Piece& piece, size_t first,
                                                             Point* q) {
  Point y[N];
  const float* matrix[N];
  for (size_t i = 0; i < N; ++i) {
    matrix[i] =
        piece.matrices + size_t{piece.handles[first + i]} * piece.num_shapes * kMatrixFloats;
    for (size_t row = 0; row < 3; ++row)
      y[i].axis[row] = Splat(matrix[i][row * 4 + 3]);
  }
  for (size_t s = 0; s < piece.num_block_shapes; ++s) {
    const Point p = LoadPoint(piece.points + s * 3 * kLanes);
    const size_t offset = piece.shape_offsets[s];
    for (size_t i = 0; i < N; ++i)
      AddLinear(matrix[i] + offset, p, &y[i]);
  }
  for (size_t i = 0; i < N; ++i) {
    const Lanes weight = Load(piece.weights + (first + i) * kLanes);
    for (size_t row = 0; row < 3; ++row)
      q->axis[row] = MulAdd(weight, y[i].axis[row], q->axis[row]);
  }
}

// All handles of the block, in groups of nearly the same size.
static inline __attribute__((always_inline)) Point SkinPiece(const Piece& piece, size_t count) {
  Point q = {};
  const size_t groups = (count + kMostHandles - 1) / kMostHandles;
  for (size_t group = 0, first = 0; group < groups; ++group) {
    const size_t size = (count - first + groups - group - 1) / (groups - group);
    switch (size) {
      case 1:
        AddHandles<1>(piece, first, &q);
        break;
      case 2:
        AddHandles<2>(piece, first, &q);
        break;
      case 3:
        AddHandles<3>(piece, first, &q);
        break;
      default:
        AddHandles<kMostHandles>(piece, first, &q);
    }
    first += size;
  }
  return q;
}

static void Skin(const SkinBlocks& blocks, const float* matrices, const float* origin, float* out) {
  const size_t num_vertices = blocks.num_vertices;
  for (size_t begin = 0; begin < num_vertices; begin += kLanes) {
    const size_t block = begin / kLanes;
    const size_t first = blocks.first_handle[block], count = blocks.first_handle[block + 1] - first;
    const size_t shape = blocks.first_shape[block];
    float q[3][kLanes];
    for (size_t lane = 0; lane < kLanes; lane += kWidth) {
      const Piece piece = {matrices,
                           blocks.weights + first * kLanes + lane,
                           blocks.points + shape * 3 * kLanes + lane,
                           blocks.handles + first,
                           blocks.shape_offsets + shape,
                           blocks.first_shape[block + 1] - shape,
                           blocks.num_shapes};
      const Point skinned = SkinPiece(piece, count);
      for (size_t row = 0; row < 3; ++row) {
        const Lanes placed = skinned.axis[row] + Splat(origin[row]);
        __builtin_memcpy(&q[row][lane], &placed, sizeof(Lanes));
      }
    }
    const size_t left = num_vertices - begin, end = left < kLanes ? left : kLanes;
    for (size_t lane = 0; lane < end; ++lane) {
      float* to = out + size_t{3} * blocks.order[begin + lane];
      to[0] = q[0][lane];
      to[1] = q[1][lane];
      to[2] = q[2][lane];
    }
  }
}

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
