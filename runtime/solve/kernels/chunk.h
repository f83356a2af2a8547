// A whole chunk's lanes as one number: arithmetic on several registers at once where one does not
// hold them, so that long chains of operations (a matrix inverse, say) hide each other's latency.
// Included only by the kernels; see lanes.h.
#pragma once

#include "solve/kernels/lanes.h"

namespace limber::LIMBER_KERNEL_NAMESPACE {

struct Chunk {
  Lanes part[kChunkParts];
};

struct ChunkMask {
  Mask part[kChunkParts];  // -1 where true
};

#define LIMBER_CHUNK_OPERATION(Result, signature, expression)     \
  static inline __attribute__((always_inline)) Result signature { \
    Result result;                                                \
    for (size_t p = 0; p < kChunkParts; ++p) {                    \
      result.part[p] = expression;                                \
    }                                                             \
    return result;                                                \
  }

LIMBER_CHUNK_OPERATION(Chunk, operator+(const Chunk& a, const Chunk& b), a.part[p] + b.part[p])
LIMBER_CHUNK_OPERATION(Chunk, operator-(const Chunk& a, const Chunk& b), a.part[p] - b.part[p])
LIMBER_CHUNK_OPERATION(Chunk, operator*(const Chunk& a, const Chunk& b), a.part[p] * b.part[p])
LIMBER_CHUNK_OPERATION(Chunk, operator-(const Chunk& a, double b), a.part[p] - b)
LIMBER_CHUNK_OPERATION(Chunk, operator*(double a, const Chunk& b), a* b.part[p])
LIMBER_CHUNK_OPERATION(Chunk, operator/(double a, const Chunk& b), a / b.part[p])
LIMBER_CHUNK_OPERATION(ChunkMask, operator>(const Chunk& a, double b), a.part[p] > Splat(b))
LIMBER_CHUNK_OPERATION(ChunkMask, operator<=(const Chunk& a, double b), a.part[p] <= Splat(b))
LIMBER_CHUNK_OPERATION(ChunkMask, operator&(const ChunkMask& a, const ChunkMask& b),
                       a.part[p] & b.part[p])
LIMBER_CHUNK_OPERATION(ChunkMask, operator|(const ChunkMask& a, const ChunkMask& b),
                       a.part[p] | b.part[p])
LIMBER_CHUNK_OPERATION(ChunkMask, operator~(const ChunkMask& a), ~a.part[p])
LIMBER_CHUNK_OPERATION(Chunk, Select(const ChunkMask& mask, const Chunk& a, const Chunk& b),
                       mask.part[p] ? a.part[p] : b.part[p])
LIMBER_CHUNK_OPERATION(Chunk, MulAdd(const Chunk& a, const Chunk& b, const Chunk& c),
                       MulAdd(a.part[p], b.part[p], c.part[p]))
LIMBER_CHUNK_OPERATION(Chunk, MulSub(const Chunk& a, const Chunk& b, const Chunk& c),
                       MulAdd(a.part[p], b.part[p], -c.part[p]))
LIMBER_CHUNK_OPERATION(Chunk, Abs(const Chunk& a), Abs(a.part[p]))
LIMBER_CHUNK_OPERATION(Chunk, Max(const Chunk& a, const Chunk& b), Max(a.part[p], b.part[p]))
LIMBER_CHUNK_OPERATION(Chunk, SplatChunk(double value), Splat(value))
LIMBER_CHUNK_OPERATION(Chunk, LoadChunk(const double* from), Load(from + p * kWidth))

#undef LIMBER_CHUNK_OPERATION

static inline __attribute__((always_inline)) void Store(const Chunk& chunk, double* to) {
  for (size_t p = 0; p < kChunkParts; ++p)
    Store(chunk.part[p], to + p * kWidth);
}

static inline __attribute__((always_inline)) bool IsSet(const ChunkMask& mask, size_t lane) {
  return mask.part[lane / kWidth][lane % kWidth] != 0;
}

static inline __attribute__((always_inline)) bool AreAllSet(const ChunkMask& mask) {
  Mask all = mask.part[0];
  for (size_t p = 1; p < kChunkParts; ++p)
    all &= mask.part[p];
  int64_t every = -1;
  for (size_t lane = 0; lane < kWidth; ++lane)
    every &= all[lane];
  return every != 0;
}

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
