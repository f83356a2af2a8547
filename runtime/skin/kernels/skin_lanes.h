// As many floats as one register of the instruction set holds, and what skinning does with them.
//
// Included only by the kernels, which are compiled once for each instruction set; so nothing here
// has external linkage, and nothing of the standard library is inlined from here.
#pragma once

#include "skin/kernels/skin_kernels.h"

#include <stddef.h>
#include <stdint.h>

#if defined(__FMA__) || defined(__AVX512F__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__ARM_NEON) && defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace limber::LIMBER_KERNEL_NAMESPACE {

#if defined(__AVX512F__)
constexpr size_t kWidth = 16;
#elif defined(__AVX__)
constexpr size_t kWidth = 8;
#else
constexpr size_t kWidth = 4;
#endif
constexpr size_t kLanes = kSkinLanes;

using Lanes = float __attribute__((vector_size(kWidth * sizeof(float))));

using Mask = int32_t __attribute__((vector_size(kWidth * sizeof(int32_t))));  // -1 where true

static inline __attribute__((always_inline)) Lanes Load(const float* from) {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

static inline __attribute__((always_inline)) Lanes Splat(float value) {
#if defined(__AVX512F__)
  return _mm512_set1_ps(value);
#elif defined(__AVX__)
  return _mm256_set1_ps(value);
#else
  return Lanes{value, value, value, value};
#endif
}

// a b + c, rounded once where the machine can.
static inline __attribute__((always_inline)) Lanes MulAdd(Lanes a, Lanes b, Lanes c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_ps(a, b, c);
#elif defined(__FMA__)
  return _mm256_fmadd_ps(a, b, c);
#elif defined(__ARM_NEON) && defined(__aarch64__)
  return vfmaq_f32(c, a, b);
#else
  return a * b + c;
#endif
}

// Rounded correctly, as everywhere.
static inline __attribute__((always_inline)) Lanes SquareRoot(Lanes a) {
#if defined(__AVX512F__)
  return _mm512_sqrt_ps(a);
#elif defined(__AVX__)
  return _mm256_sqrt_ps(a);
#elif defined(__SSE2__)
  return _mm_sqrt_ps(a);
#else
  return Lanes{__builtin_sqrtf(a[0]), __builtin_sqrtf(a[1]), __builtin_sqrtf(a[2]),
               __builtin_sqrtf(a[3])};
#endif
}

// Rows of four floats, one for each lane, as four columns of lanes and back. Registers hold four
// rows of each quarter; so nothing crosses a quarter.
struct Columns {
  Lanes column[4];
};

#if defined(__AVX512F__) || defined(__AVX__)

#if defined(__AVX512F__)
#define LIMBER_WIDE(operation) _mm512_##operation
#else
#define LIMBER_WIDE(operation) _mm256_##operation
#endif

// The 4x4 transposes, which are their own inverses.
static inline __attribute__((always_inline)) Columns Transposed(const Columns& a) {
  const Lanes low01 = LIMBER_WIDE(unpacklo_ps)(a.column[0], a.column[1]);
  const Lanes low23 = LIMBER_WIDE(unpacklo_ps)(a.column[2], a.column[3]);
  const Lanes high01 = LIMBER_WIDE(unpackhi_ps)(a.column[0], a.column[1]);
  const Lanes high23 = LIMBER_WIDE(unpackhi_ps)(a.column[2], a.column[3]);
  return {{LIMBER_WIDE(shuffle_ps)(low01, low23, 0x44), LIMBER_WIDE(shuffle_ps)(low01, low23, 0xEE),
           LIMBER_WIDE(shuffle_ps)(high01, high23, 0x44),
           LIMBER_WIDE(shuffle_ps)(high01, high23, 0xEE)}};
}

#undef LIMBER_WIDE

template <class Offset>
static inline __attribute__((always_inline)) Columns LoadRows(const float* base,
                                                              const Offset* offsets) {
  Columns rows;
  for (size_t i = 0; i < 4; ++i) {
    const __m128 first = _mm_loadu_ps(base + offsets[i]);
#if defined(__AVX512F__)
    __m512 row = _mm512_castps128_ps512(first);
    row = _mm512_insertf32x4(row, _mm_loadu_ps(base + offsets[4 + i]), 1);
    row = _mm512_insertf32x4(row, _mm_loadu_ps(base + offsets[8 + i]), 2);
    rows.column[i] = _mm512_insertf32x4(row, _mm_loadu_ps(base + offsets[12 + i]), 3);
#else
    rows.column[i] =
        _mm256_insertf128_ps(_mm256_castps128_ps256(first), _mm_loadu_ps(base + offsets[4 + i]), 1);
#endif
  }
  return Transposed(rows);
}

static inline __attribute__((always_inline)) void StoreRows(const Columns& columns, float* base,
                                                            const size_t* offsets) {
  const Columns rows = Transposed(columns);
  for (size_t i = 0; i < 4; ++i) {
#if defined(__AVX512F__)
    _mm_storeu_ps(base + offsets[i], _mm512_castps512_ps128(rows.column[i]));
    _mm_storeu_ps(base + offsets[4 + i], _mm512_extractf32x4_ps(rows.column[i], 1));
    _mm_storeu_ps(base + offsets[8 + i], _mm512_extractf32x4_ps(rows.column[i], 2));
    _mm_storeu_ps(base + offsets[12 + i], _mm512_extractf32x4_ps(rows.column[i], 3));
#else
    _mm_storeu_ps(base + offsets[i], _mm256_castps256_ps128(rows.column[i]));
    _mm_storeu_ps(base + offsets[4 + i], _mm256_extractf128_ps(rows.column[i], 1));
#endif
  }
}

#else

template <class Offset>
static inline __attribute__((always_inline)) Columns LoadRows(const float* base,
                                                              const Offset* offsets) {
  Columns columns;
  for (size_t i = 0; i < 4; ++i) {
    columns.column[i] = Lanes{base[offsets[0] + i], base[offsets[1] + i], base[offsets[2] + i],
                              base[offsets[3] + i]};
  }
  return columns;
}

static inline __attribute__((always_inline)) void StoreRows(const Columns& columns, float* base,
                                                            const size_t* offsets) {
  for (size_t lane = 0; lane < kWidth; ++lane) {
    for (size_t i = 0; i < 4; ++i)
      base[offsets[lane] + i] = columns.column[i][lane];
  }
}

#endif

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
