#include "bake/lane_cholesky_kernels.h"

#include <cmath>
#include <cstddef>

// One function, compiled for several instruction sets, chosen when the program starts.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define LIMBER_FOR_EACH_INSTRUCTION_SET __attribute__((target_clones("avx2", "default")))
#else
#define LIMBER_FOR_EACH_INSTRUCTION_SET
#endif

namespace limber::bake {
namespace {

#define LIMBER_INLINE inline __attribute__((always_inline))

// Four lanes, kParts of which are a number; and the same wherever they lie in memory.
using Four = double __attribute__((vector_size(32)));
using FourInMemory = double __attribute__((vector_size(32), aligned(8), may_alias));

template <int kParts>
struct Lanes {
  Four part[kParts];
};

template <int kParts>
LIMBER_INLINE void Load(const double* from, Lanes<kParts>* lanes) {
  for (int p = 0; p < kParts; ++p)
    lanes->part[p] = *reinterpret_cast<const FourInMemory*>(from + ptrdiff_t{4} * p);
}

template <int kParts>
LIMBER_INLINE void Store(const Lanes<kParts>& lanes, double* to) {
  for (int p = 0; p < kParts; ++p)
    *reinterpret_cast<FourInMemory*>(to + ptrdiff_t{4} * p) = lanes.part[p];
}

// *sum -= a b, all of them numbers.
template <int kParts>
LIMBER_INLINE void SubtractProduct(const double* a, const double* b, Lanes<kParts>* sum) {
  Lanes<kParts> x, y;
  Load(a, &x);
  Load(b, &y);
  for (int p = 0; p < kParts; ++p)
    sum->part[p] -= x.part[p] * y.part[p];
}

// *sum -= sum_k a[k] b[k] over `count` numbers.
template <int kParts>
LIMBER_INLINE void SubtractDot(const double* a, const double* b, ptrdiff_t count,
                               Lanes<kParts>* sum) {
  constexpr ptrdiff_t kLanes = ptrdiff_t{4} * kParts;
  for (; count > 0; --count, a += kLanes, b += kLanes)
    SubtractProduct(a, b, sum);
}

template <int kParts>
LIMBER_INLINE void SubtractProductsOf(const ProductsView& view) {
  constexpr ptrdiff_t kLanes = ptrdiff_t{4} * kParts;
  const ptrdiff_t from_row = view.from_width * kLanes, to_row = view.to_width * kLanes;
  for (ptrdiff_t row = view.begin; row < view.from_num_rows; ++row) {
    const double* a = view.from + row * from_row;
    double* to = view.to + view.local[view.from_rows[row]] * to_row;
    const ptrdiff_t last = row < view.end ? row + 1 : view.end;
    for (ptrdiff_t column = view.begin; column < last; ++column) {
      double* number = to + (view.from_rows[column] - view.to_first) * kLanes;
      Lanes<kParts> sum;
      Load(number, &sum);
      SubtractDot(a, view.from + column * from_row, view.from_width, &sum);
      Store(sum, number);
    }
  }
}

// *number = sqrt(*number) where that is positive, else 1, and *definite = false.
LIMBER_INLINE void TakeRoot(double* number, bool* definite) {
  const bool positive = *number > 0;
  *number = positive ? std::sqrt(*number) : 1;
  if (!positive) *definite = false;
}

template <int kParts>
LIMBER_INLINE void FactorPanelOf(double* panel, ptrdiff_t num_rows, ptrdiff_t width,
                                 bool* definite) {
  constexpr ptrdiff_t kLanes = ptrdiff_t{4} * kParts;
  for (ptrdiff_t row = 0; row < num_rows; ++row) {
    double* a = panel + row * width * kLanes;
    for (ptrdiff_t column = 0; column < width && column <= row; ++column) {
      const double* pivot = panel + (column * width + column) * kLanes;
      Lanes<kParts> sum;
      Load(a + column * kLanes, &sum);
      SubtractDot(a, panel + column * width * kLanes, column, &sum);
      if (row != column) {
        Lanes<kParts> divisor;
        Load(pivot, &divisor);
        for (int p = 0; p < kParts; ++p)
          sum.part[p] /= divisor.part[p];
      }
      Store(sum, a + column * kLanes);
      for (ptrdiff_t lane = 0; row == column && lane < kLanes; ++lane)
        TakeRoot(a + column * kLanes + lane, definite + lane);
    }
    for (ptrdiff_t i = (row + 1) * kLanes; i < width * kLanes; ++i)
      a[i] = 0;  // above the diagonal
  }
}

template <int kParts>
LIMBER_INLINE void SolveForwardOf(const PanelView& panel, double* x) {
  constexpr ptrdiff_t kLanes = ptrdiff_t{4} * kParts;
  double* top = x + panel.rows[0] * kLanes;
  for (ptrdiff_t row = 0; row < panel.num_rows; ++row) {
    const double* values = panel.values + row * panel.width * kLanes;
    double* to = x + panel.rows[row] * kLanes;
    Lanes<kParts> sum;
    Load(to, &sum);
    SubtractDot(values, top, row < panel.width ? row : panel.width, &sum);
    if (row < panel.width) {
      Lanes<kParts> divisor;
      Load(values + row * kLanes, &divisor);
      for (int p = 0; p < kParts; ++p)
        sum.part[p] /= divisor.part[p];
    }
    Store(sum, to);
  }
}

// x[k] -= sum over kRows rows from `row` on of L[row][k] x[row], for the first `count` columns k.
template <int kParts, int kRows>
LIMBER_INLINE void TakeRows(const PanelView& panel, ptrdiff_t row, ptrdiff_t count, double* x) {
  constexpr ptrdiff_t kLanes = ptrdiff_t{4} * kParts;
  const ptrdiff_t stride = panel.width * kLanes;
  const double* values = panel.values + row * stride;
  Lanes<kParts> numbers[kRows];
  for (int r = 0; r < kRows; ++r)
    Load(x + panel.rows[row + r] * kLanes, &numbers[r]);
  double* to = x + panel.rows[0] * kLanes;
  for (ptrdiff_t k = 0; k < count * kLanes; k += kLanes) {
    Lanes<kParts> sum;
    Load(to + k, &sum);
    for (int r = 0; r < kRows; ++r) {
      Lanes<kParts> value;
      Load(values + r * stride + k, &value);
      for (int p = 0; p < kParts; ++p)
        sum.part[p] -= value.part[p] * numbers[r].part[p];
    }
    Store(sum, to + k);
  }
}

template <int kParts>
LIMBER_INLINE void SolveBackwardOf(const PanelView& panel, double* x) {
  constexpr ptrdiff_t kLanes = ptrdiff_t{4} * kParts;
  ptrdiff_t row = panel.num_rows;
  for (; row - 4 >= panel.width; row -= 4)
    TakeRows<kParts, 4>(panel, row - 4, panel.width, x);
  for (; row > panel.width; --row)
    TakeRows<kParts, 1>(panel, row - 1, panel.width, x);
  while (row-- > 0) {
    double* number = x + panel.rows[row] * kLanes;
    Lanes<kParts> value, divisor;
    Load(number, &value);
    Load(panel.values + (row * panel.width + row) * kLanes, &divisor);
    for (int p = 0; p < kParts; ++p)
      value.part[p] /= divisor.part[p];
    Store(value, number);
    TakeRows<kParts, 1>(panel, row, row, x);
  }
}

}  // namespace

LIMBER_FOR_EACH_INSTRUCTION_SET
void SubtractProducts(const ProductsView& view, int lanes) {
  lanes == 4 ? SubtractProductsOf<1>(view) : SubtractProductsOf<2>(view);
}

LIMBER_FOR_EACH_INSTRUCTION_SET
void FactorPanel(double* panel, ptrdiff_t num_rows, ptrdiff_t width, int lanes, bool* definite) {
  lanes == 4 ? FactorPanelOf<1>(panel, num_rows, width, definite)
             : FactorPanelOf<2>(panel, num_rows, width, definite);
}

LIMBER_FOR_EACH_INSTRUCTION_SET
void SolveForward(const PanelView& panel, int lanes, double* x) {
  lanes == 4 ? SolveForwardOf<1>(panel, x) : SolveForwardOf<2>(panel, x);
}

LIMBER_FOR_EACH_INSTRUCTION_SET
void SolveBackward(const PanelView& panel, int lanes, double* x) {
  lanes == 4 ? SolveBackwardOf<1>(panel, x) : SolveBackwardOf<2>(panel, x);
}

}  // namespace limber::bake
