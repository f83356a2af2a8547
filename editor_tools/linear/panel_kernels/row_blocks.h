// Blocks of rows in registers. Included as panel_kernels_body.h is, and by it alone.
#pragma once

#include "linear/panel_kernels/panel_kernels.h"
#include "solve/kernels/lanes.h"

namespace limber::linear::LIMBER_KERNEL_NAMESPACE {

#define LIMBER_INLINE static inline __attribute__((always_inline))
#if defined(__clang__)
#define LIMBER_UNROLL _Pragma("clang loop unroll(full)")
#else
#define LIMBER_UNROLL _Pragma("GCC unroll 8")
#endif

// Registers and their arithmetic are the solver's.
using ::limber::LIMBER_KERNEL_NAMESPACE::kWidth;
using ::limber::LIMBER_KERNEL_NAMESPACE::Load;
using ::limber::LIMBER_KERNEL_NAMESPACE::MulSub;
using ::limber::LIMBER_KERNEL_NAMESPACE::Splat;
using ::limber::LIMBER_KERNEL_NAMESPACE::Store;
using Register = ::limber::LIMBER_KERNEL_NAMESPACE::Lanes;

constexpr int kRegisters = kBlockRows / static_cast<int>(kWidth);
constexpr ptrdiff_t kColumnStep = kBlockRows;  // doubles from one column of a block to the next

// A tile's sums stay in registers while the products run through: 16 of AVX-512's 32, 8 of 16.
#if defined(__AVX512F__)
constexpr int kTileBlocks = 4, kTileColumns = 4;
#elif defined(__AVX__)
constexpr int kTileBlocks = 1, kTileColumns = 4;
#else
constexpr int kTileBlocks = 1, kTileColumns = 2;
#endif

struct Block {
  Register part[kRegisters];
};

LIMBER_INLINE Block Zero() {
  Block block;
  for (int i = 0; i < kRegisters; ++i)
    block.part[i] = Register{};
  return block;
}

// Register by register: as one copy, the compiler would take it through memory.
LIMBER_INLINE Block LoadBlock(const double* from) {
  Block block;
  for (int i = 0; i < kRegisters; ++i)
    block.part[i] = Load(from + static_cast<size_t>(i) * kWidth);
  return block;
}

LIMBER_INLINE void StoreBlock(const Block& block, double* to) {
  for (int i = 0; i < kRegisters; ++i)
    Store(block.part[i], to + static_cast<size_t>(i) * kWidth);
}

LIMBER_INLINE Block MulSub(const Block& a, const Block& b, Block c) {
  for (int i = 0; i < kRegisters; ++i)
    c.part[i] = MulSub(a.part[i], b.part[i], c.part[i]);
  return c;
}

LIMBER_INLINE Block MulSub(const Block& a, double b, Block c) {
  const Register number = Splat(b);
  for (int i = 0; i < kRegisters; ++i)
    c.part[i] = MulSub(a.part[i], number, c.part[i]);
  return c;
}

LIMBER_INLINE Block Sum(Block a, const Block& b) {
  for (int i = 0; i < kRegisters; ++i)
    a.part[i] += b.part[i];
  return a;
}

// Adds those rows of a block whose bits are set to a column that would hold all of them.
#if defined(__AVX512F__)
constexpr bool kHasMasks = true;

LIMBER_INLINE void AddRows(const Block& block, unsigned rows, double* to) {
  const __mmask8 mask = (__mmask8)rows;
  const Register sum = _mm512_maskz_loadu_pd(mask, to) + block.part[0];
  _mm512_mask_storeu_pd(to, mask, sum);
}
#else
constexpr bool kHasMasks = false;  // or slow ones

LIMBER_INLINE void AddRows(const Block&, unsigned, double*) {}
#endif

LIMBER_INLINE Block Difference(Block a, const Block& b) {
  for (int i = 0; i < kRegisters; ++i)
    a.part[i] -= b.part[i];
  return a;
}

LIMBER_INLINE Block Product(Block a, double b) {
  const Register number = Splat(b);
  for (int i = 0; i < kRegisters; ++i)
    a.part[i] *= number;
  return a;
}

LIMBER_INLINE ptrdiff_t NumBlocks(ptrdiff_t num_rows) {
  return (num_rows + kBlockRows - 1) / kBlockRows;
}

struct Panel {
  const double* values;
  ptrdiff_t width;

  // The first column of a row; the next ones follow at a distance of kBlockRows.
  const double* Row(ptrdiff_t row) const {
    return values + row / kBlockRows * width * kBlockRows + row % kBlockRows;
  }
};

// sums[b][c] -= sum over the first `count` columns k of the rows of a's (block + b) times the
// number of the other panel's (row + c). Both have one width.
template <int kBlocks, int kColumns>
LIMBER_INLINE void SubtractProductsOf(const Panel& a, ptrdiff_t block, const Panel& other,
                                      ptrdiff_t row, ptrdiff_t count, Block (*sums)[kColumns]) {
  const ptrdiff_t block_step = a.width * kBlockRows;
  const double* blocks = a.values + block * block_step;
  const double* rows[kColumns];
  LIMBER_UNROLL
  for (int c = 0; c < kColumns; ++c)
    rows[c] = other.Row(row + c);
  for (ptrdiff_t k = 0; k < count * kBlockRows; k += kBlockRows) {
    Register number[kColumns];
    LIMBER_UNROLL
    for (int c = 0; c < kColumns; ++c)
      number[c] = Splat(rows[c][k]);
    LIMBER_UNROLL
    for (int b = 0; b < kBlocks; ++b) {
      const Block column = LoadBlock(blocks + b * block_step + k);
      LIMBER_UNROLL
      for (int c = 0; c < kColumns; ++c) {
        for (int i = 0; i < kRegisters; ++i)
          sums[b][c].part[i] = MulSub(column.part[i], number[c], sums[b][c].part[i]);
      }
    }
  }
}

}  // namespace limber::linear::LIMBER_KERNEL_NAMESPACE
