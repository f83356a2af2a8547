// As many doubles as one register of the instruction set holds, and what kernels do with them.
//
// Lanes never meet (but in Sum, whose order is fixed), nothing is reordered, and where a product is
// added without being rounded first is written out (MulAdd) rather than left to the compiler. So
// all instruction sets with a fused multiply-add give the same bits; the baseline of x86-64, which
// has none, gives its own.
//
// Included only by the kernels, which are compiled once for each instruction set; so nothing here
// has external linkage, and nothing of the standard library is inlined from here (a copy compiled
// for AVX-512 could be the one that the linker keeps for everyone).
#pragma once

#include <stddef.h>
#include <stdint.h>

#if defined(__FMA__) || defined(__AVX512F__)
#include <immintrin.h>
#elif defined(__ARM_NEON) && defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace limber::LIMBER_KERNEL_NAMESPACE {

#if defined(__AVX512F__)
constexpr size_t kWidth = 8;
#elif defined(__AVX__)
constexpr size_t kWidth = 4;
#else
constexpr size_t kWidth = 2;
#endif
constexpr size_t kLanes = 8;                     // of a chunk (solve_kernels.h)
constexpr size_t kChunkParts = kLanes / kWidth;  // registers that hold them

using Lanes = double __attribute__((vector_size(kWidth * sizeof(double))));
using Mask = int64_t __attribute__((vector_size(kWidth * sizeof(int64_t))));  // -1 where true

static inline __attribute__((always_inline)) Lanes Load(const double* from) {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

static inline __attribute__((always_inline)) Lanes Load(const float* from) {
#if defined(__AVX512F__)
  return _mm512_cvtps_pd(_mm256_loadu_ps(from));
#elif defined(__AVX__)
  return _mm256_cvtps_pd(_mm_loadu_ps(from));
#else
  return Lanes{static_cast<double>(from[0]), static_cast<double>(from[1])};
#endif
}

static inline __attribute__((always_inline)) void Store(Lanes lanes, double* to) {
  __builtin_memcpy(to, &lanes, sizeof(lanes));
}

static inline __attribute__((always_inline)) Lanes Splat(double value) {
#if defined(__AVX512F__)
  return Lanes{value, value, value, value, value, value, value, value};
#elif defined(__AVX__)
  return Lanes{value, value, value, value};
#else
  return Lanes{value, value};
#endif
}

// a b + c, rounded once where the machine can.
static inline __attribute__((always_inline)) Lanes MulAdd(Lanes a, Lanes b, Lanes c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_pd(a, b, c);
#elif defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#elif defined(__ARM_NEON) && defined(__aarch64__)
  return vfmaq_f64(c, a, b);
#else
  return a * b + c;
#endif
}

// c - a b, likewise.
static inline __attribute__((always_inline)) Lanes MulSub(Lanes a, Lanes b, Lanes c) {
#if defined(__AVX512F__)
  return _mm512_fnmadd_pd(a, b, c);
#elif defined(__FMA__)
  return _mm256_fnmadd_pd(a, b, c);
#elif defined(__ARM_NEON) && defined(__aarch64__)
  return vfmsq_f64(c, a, b);
#else
  return c - a * b;
#endif
}

static inline __attribute__((always_inline)) Lanes Abs(Lanes a) {
  return a < 0 ? -a : a;
}

static inline __attribute__((always_inline)) Lanes Max(Lanes a, Lanes b) {
  return a > b ? a : b;
}

static inline __attribute__((always_inline)) Lanes SquareRoot(Lanes a) {
#if defined(__AVX512F__)
  return _mm512_sqrt_pd(a);
#elif defined(__AVX__)
  return _mm256_sqrt_pd(a);
#else
  return Lanes{__builtin_sqrt(a[0]), __builtin_sqrt(a[1])};
#endif
}

// Four doubles, whatever the width: for matrices and rows that are no planes. (Of so many registers
// as they take: one that holds them all is no argument for a function of the baseline.)
constexpr size_t kQuadWidth = 4;
constexpr size_t kQuadParts = kWidth < kQuadWidth ? kQuadWidth / kWidth : 1;

#if defined(__AVX__)
using QuadPart = double __attribute__((vector_size(kQuadWidth * sizeof(double))));
#else
using QuadPart = Lanes;
#endif

struct Quad {
  QuadPart part[kQuadParts];

  __attribute__((always_inline)) double operator[](size_t i) const {
    return part[i / (kQuadWidth / kQuadParts)][i % (kQuadWidth / kQuadParts)];
  }
};

static inline __attribute__((always_inline)) Quad LoadQuad(const double* from) {
  Quad quad;
  __builtin_memcpy(&quad, from, sizeof(quad));
  return quad;
}

static inline __attribute__((always_inline)) void StoreQuad(const Quad& quad, double* to) {
  __builtin_memcpy(to, &quad, sizeof(quad));
}

// value b + c.
static inline __attribute__((always_inline)) Quad MulAdd(double value, const Quad& b,
                                                         const Quad& c) {
  Quad result;
  for (size_t p = 0; p < kQuadParts; ++p) {
#if defined(__FMA__)
    result.part[p] = _mm256_fmadd_pd(_mm256_set1_pd(value), b.part[p], c.part[p]);
#else
    result.part[p] = MulAdd(Splat(value), b.part[p], c.part[p]);
#endif
  }
  return result;
}

static inline __attribute__((always_inline)) Quad MulAdd(const Quad& a, const Quad& b,
                                                         const Quad& c) {
  Quad result;
  for (size_t p = 0; p < kQuadParts; ++p) {
#if defined(__FMA__)
    result.part[p] = _mm256_fmadd_pd(a.part[p], b.part[p], c.part[p]);
#else
    result.part[p] = MulAdd(a.part[p], b.part[p], c.part[p]);
#endif
  }
  return result;
}

// Of a whole chunk's lanes: (0+4)+(2+6) + (1+5)+(3+7) on every machine.
static inline double Sum(const Lanes (&lanes)[kChunkParts]) {
  double a[kLanes];
  __builtin_memcpy(a, &lanes, sizeof(a));
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
