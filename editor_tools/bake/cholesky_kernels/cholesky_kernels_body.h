// The kernels themselves. Included only by the files that compile them, once for each instruction
// set; so nothing here has external linkage, and nothing of the standard library is inlined from
// here (a copy compiled for AVX-512 could be the one that the linker keeps for everyone).
#pragma once

#include "bake/cholesky_kernels/cholesky_kernels.h"

#if defined(__FMA__) || defined(__AVX512F__)
#include <immintrin.h>
#elif defined(__ARM_NEON) && defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace limber::bake::LIMBER_KERNEL_NAMESPACE {

#define LIMBER_INLINE static inline __attribute__((always_inline))

// The lanes of a number are taken kWidth at a time, a register's worth.
template <int kWidth>
struct RegisterOf;

template <>
struct RegisterOf<2> {
  using Type = double __attribute__((vector_size(16)));
};

template <>
struct RegisterOf<4> {
  using Type = double __attribute__((vector_size(32)));
};

template <>
struct RegisterOf<8> {
  using Type = double __attribute__((vector_size(64)));
};

template <int kWidth>
using Lanes = typename RegisterOf<kWidth>::Type;

#if defined(__AVX512F__)
constexpr int kWidest = 8;
#elif defined(__AVX__)
constexpr int kWidest = 4;
#else
constexpr int kWidest = 2;
#endif

// A tile's sums stay in registers while the products run through: 16 of AVX-512's 32, 8 of 16.
#if defined(__AVX512F__)
constexpr int kTileRows = 4;
#else
constexpr int kTileRows = 2;
#endif
constexpr int kTileColumns = 4;
constexpr int kColumnsAtOnce = 8, kRowsAtOnce = 32;

template <int kWidth>
LIMBER_INLINE Lanes<kWidth> Load(const double* from) {
  Lanes<kWidth> lanes;
  __builtin_memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

template <int kWidth>
LIMBER_INLINE void Store(Lanes<kWidth> lanes, double* to) {
  __builtin_memcpy(to, &lanes, sizeof(lanes));
}

// c - a b, rounded once where the machine can.
template <int kWidth>
LIMBER_INLINE Lanes<kWidth> MulSub(Lanes<kWidth> a, Lanes<kWidth> b, Lanes<kWidth> c) {
#if defined(__AVX512F__)
  if constexpr (kWidth == 8) return _mm512_fnmadd_pd(a, b, c);
#endif
#if defined(__FMA__)
  if constexpr (kWidth == 4) return _mm256_fnmadd_pd(a, b, c);
#endif
#if defined(__ARM_NEON) && defined(__aarch64__)
  if constexpr (kWidth == 2) return vfmsq_f64(c, a, b);
#endif
  return c - a * b;
}

// Rows of two blocks whose numbers are multiplied with each other.
struct Rows {
  const double *a, *b;
  ptrdiff_t row_step;  // doubles from one row to the next, of both
  ptrdiff_t count;     // numbers of a row that take part
  ptrdiff_t lanes;     // doubles from one number to the next
};

// sums[r][c] -= sum_k a[r][k] b[c][k].
template <int kWidth, int kRows, int kColumns>
LIMBER_INLINE void SubtractProductsOf(const Rows& rows, Lanes<kWidth> (*sums)[kColumns]) {
  for (ptrdiff_t k = 0; k < rows.count * rows.lanes; k += rows.lanes) {
    Lanes<kWidth> column[kColumns];
    for (int c = 0; c < kColumns; ++c)
      column[c] = Load<kWidth>(rows.b + c * rows.row_step + k);
    for (int r = 0; r < kRows; ++r) {
      const Lanes<kWidth> row = Load<kWidth>(rows.a + r * rows.row_step + k);
      for (int c = 0; c < kColumns; ++c)
        sums[r][c] = MulSub<kWidth>(row, column[c], sums[r][c]);
    }
  }
}

// Where the numbers of a tile lie that products are taken from.
struct Places {
  double* row[kTileRows];
  ptrdiff_t column[kTileColumns];  // doubles from the row's begin
};

template <int kWidth, int kRows, int kColumns>
LIMBER_INLINE void UpdateTile(Rows rows, const Places& to) {
  for (ptrdiff_t part = 0; part < rows.lanes; part += kWidth, rows.a += kWidth, rows.b += kWidth) {
    Lanes<kWidth> sums[kRows][kColumns];
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kColumns; ++c)
        sums[r][c] = Load<kWidth>(to.row[r] + to.column[c] + part);
    }
    SubtractProductsOf<kWidth, kRows, kColumns>(rows, sums);
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kColumns; ++c)
        Store<kWidth>(sums[r][c], to.row[r] + to.column[c] + part);
    }
  }
}

// The columns from `column` on of the rows that `rows.a` and `to` hold.
template <int kWidth, int kRows, int kColumns>
LIMBER_INLINE void UpdateColumns(const ProductsView& view, ptrdiff_t column, Rows rows,
                                 Places* to) {
  rows.b = view.from + column * rows.row_step;
  for (int c = 0; c < kColumns; ++c)
    to->column[c] = (view.from_rows[column + c] - view.to_first) * rows.lanes;
  UpdateTile<kWidth, kRows, kColumns>(rows, *to);
}

// Columns from `first` up to `end` of the view, those that kRows rows from `row` on have a part in.
template <int kWidth, int kRows>
LIMBER_INLINE void UpdateRows(const ProductsView& view, ptrdiff_t row, ptrdiff_t first,
                              ptrdiff_t end, ptrdiff_t lanes) {
  const ptrdiff_t row_step = view.from_width * lanes;
  const Rows rows{view.from + row * row_step, nullptr, row_step, view.from_width, lanes};
  Places to;
  for (int r = 0; r < kRows; ++r)
    to.row[r] = view.to + view.local[view.from_rows[row + r]] * view.to_width * lanes;
  if (end > row + kRows) end = row + kRows;
  ptrdiff_t column = first;
  for (; column + kTileColumns <= end; column += kTileColumns)
    UpdateColumns<kWidth, kRows, kTileColumns>(view, column, rows, &to);
  if (end - column >= 2) {
    UpdateColumns<kWidth, kRows, 2>(view, column, rows, &to);
    column += 2;
  }
  if (end - column >= 1) UpdateColumns<kWidth, kRows, 1>(view, column, rows, &to);
}

// Rows from `row` up to `end` with columns from `first` on.
template <int kWidth>
LIMBER_INLINE void UpdateBlock(const ProductsView& view, ptrdiff_t row, ptrdiff_t end_row,
                               ptrdiff_t first, ptrdiff_t lanes) {
  const ptrdiff_t next = first + kColumnsAtOnce;
  const ptrdiff_t end = next < view.end ? next : view.end;
  if (row < first) row = first;
  for (; row + kTileRows <= end_row; row += kTileRows)
    UpdateRows<kWidth, kTileRows>(view, row, first, end, lanes);
  for (; row < end_row; ++row)
    UpdateRows<kWidth, 1>(view, row, first, end, lanes);
}

// Rows pass by once, a block of them at a time, which stays in the second-level cache while a few
// columns after the other, which stay in the first, meet it.
template <int kWidth>
LIMBER_INLINE void SubtractProducts(const ProductsView& view, ptrdiff_t lanes) {
  for (ptrdiff_t row = view.begin; row < view.from_num_rows; row += kRowsAtOnce) {
    const ptrdiff_t next = row + kRowsAtOnce;
    const ptrdiff_t end = next < view.from_num_rows ? next : view.from_num_rows;
    for (ptrdiff_t first = view.begin; first < view.end && first < end; first += kColumnsAtOnce)
      UpdateBlock<kWidth>(view, row, end, first, lanes);
  }
}

// Of a panel of L that is being made.
struct Panel {
  double* values;
  ptrdiff_t row_step, lanes;

  double* Row(ptrdiff_t row) const { return values + row * row_step; }
};

// sums[c] = (sums[c] - sum_{k < c} sums[k] L[c][k]) / L[c][c], one row of a tile; triangle: L of
// the tile's columns.
template <int kWidth, int kColumns>
LIMBER_INLINE void SolveTriangle(const double* triangle, const Panel& panel, Lanes<kWidth>* sums) {
  for (int c = 0; c < kColumns; ++c) {
    const double* row = triangle + c * panel.row_step;
    for (int k = 0; k < c; ++k)
      sums[c] = MulSub<kWidth>(sums[k], Load<kWidth>(row + k * panel.lanes), sums[c]);
    sums[c] *= Load<kWidth>(row + c * panel.lanes);
  }
}

// kRows rows from `row` on, kColumns columns from `column` on, whose pivots are all above these
// rows: takes off what lies left of them, then solves with the triangle of their pivots.
template <int kWidth, int kRows, int kColumns>
LIMBER_INLINE void SolveTile(const Panel& panel, ptrdiff_t row, ptrdiff_t column) {
  for (ptrdiff_t part = 0; part < panel.lanes; part += kWidth) {
    double* to = panel.Row(row) + column * panel.lanes + part;
    const double* triangle = panel.Row(column) + column * panel.lanes + part;
    Lanes<kWidth> sums[kRows][kColumns];
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kColumns; ++c)
        sums[r][c] = Load<kWidth>(to + r * panel.row_step + c * panel.lanes);
    }
    SubtractProductsOf<kWidth, kRows, kColumns>(
        {panel.Row(row) + part, panel.Row(column) + part, panel.row_step, column, panel.lanes},
        sums);
    for (int r = 0; r < kRows; ++r) {
      SolveTriangle<kWidth, kColumns>(triangle, panel, sums[r]);
      for (int c = 0; c < kColumns; ++c)
        Store<kWidth>(sums[r][c], to + r * panel.row_step + c * panel.lanes);
    }
  }
}

// The columns from 0 to `end` of kRows rows.
template <int kWidth, int kRows>
LIMBER_INLINE void SolveRows(const Panel& panel, ptrdiff_t row, ptrdiff_t end) {
  ptrdiff_t column = 0;
  for (; column + kTileColumns <= end; column += kTileColumns)
    SolveTile<kWidth, kRows, kTileColumns>(panel, row, column);
  for (; column < end; ++column)
    SolveTile<kWidth, kRows, 1>(panel, row, column);
}

// One over the root of each lane where that is positive, else one, and *definite = false.
LIMBER_INLINE void InvertRoots(double* pivot, ptrdiff_t lanes, bool* definite) {
  for (ptrdiff_t lane = 0; lane < lanes; ++lane) {
    const bool positive = pivot[lane] > 0;
    pivot[lane] = positive ? 1 / __builtin_sqrt(pivot[lane]) : 1;
    if (!positive) definite[lane] = false;
  }
}

template <int kWidth>
LIMBER_INLINE void FactorPanel(const Panel& panel, ptrdiff_t num_rows, ptrdiff_t width,
                               bool* definite) {
  for (ptrdiff_t row = 0; row < width; ++row) {
    SolveRows<kWidth, 1>(panel, row, row);
    double* pivot = panel.Row(row) + row * panel.lanes;
    UpdateTile<kWidth, 1, 1>({panel.Row(row), panel.Row(row), panel.row_step, row, panel.lanes},
                             {{pivot}, {0}});
    InvertRoots(pivot, panel.lanes, definite);
    for (ptrdiff_t i = panel.lanes; i < (width - row) * panel.lanes; ++i)
      pivot[i] = 0;
  }
  ptrdiff_t row = width;
  for (; row + kTileRows <= num_rows; row += kTileRows)
    SolveRows<kWidth, kTileRows>(panel, row, width);
  for (; row < num_rows; ++row)
    SolveRows<kWidth, 1>(panel, row, width);
}

// kRows rows' numbers of x, less their dot products with the panel's own numbers of x.
template <int kWidth, int kRows>
LIMBER_INLINE void GiveRows(const PanelView& panel, ptrdiff_t row, ptrdiff_t count, ptrdiff_t lanes,
                            double* x) {
  Places to;
  to.column[0] = 0;
  for (int r = 0; r < kRows; ++r)
    to.row[r] = x + panel.rows[row + r] * lanes;
  const ptrdiff_t row_step = panel.width * lanes;
  UpdateTile<kWidth, kRows, 1>(
      {panel.values + row * row_step, x + panel.rows[0] * lanes, row_step, count, lanes}, to);
}

LIMBER_INLINE void Multiply(const double* factors, ptrdiff_t lanes, double* x) {
  for (ptrdiff_t lane = 0; lane < lanes; ++lane)
    x[lane] *= factors[lane];
}

template <int kWidth>
LIMBER_INLINE void SolveForward(const PanelView& panel, ptrdiff_t lanes, double* x) {
  ptrdiff_t row = 0;
  for (; row < panel.width; ++row) {
    GiveRows<kWidth, 1>(panel, row, row, lanes, x);
    Multiply(panel.values + (row * panel.width + row) * lanes, lanes, x + panel.rows[row] * lanes);
  }
  for (; row + kTileRows <= panel.num_rows; row += kTileRows)
    GiveRows<kWidth, kTileRows>(panel, row, panel.width, lanes, x);
  for (; row < panel.num_rows; ++row)
    GiveRows<kWidth, 1>(panel, row, panel.width, lanes, x);
}

// x[k] -= sum over kRows rows from `row` on of L[row][k] x[row], for the first `count` columns k.
template <int kWidth, int kRows>
LIMBER_INLINE void TakeRows(const PanelView& panel, ptrdiff_t row, ptrdiff_t count, ptrdiff_t lanes,
                            double* x) {
  const ptrdiff_t row_step = panel.width * lanes;
  for (ptrdiff_t part = 0; part < lanes; part += kWidth) {
    const double* values = panel.values + row * row_step + part;
    Lanes<kWidth> numbers[kRows];
    for (int r = 0; r < kRows; ++r)
      numbers[r] = Load<kWidth>(x + panel.rows[row + r] * lanes + part);
    double* to = x + panel.rows[0] * lanes + part;
    for (ptrdiff_t k = 0; k < count * lanes; k += lanes) {
      Lanes<kWidth> sum = Load<kWidth>(to + k);
      for (int r = 0; r < kRows; ++r)
        sum = MulSub<kWidth>(Load<kWidth>(values + r * row_step + k), numbers[r], sum);
      Store<kWidth>(sum, to + k);
    }
  }
}

template <int kWidth>
LIMBER_INLINE void SolveBackward(const PanelView& panel, ptrdiff_t lanes, double* x) {
  constexpr int kRows = 4;
  ptrdiff_t row = panel.num_rows;
  for (; row - kRows >= panel.width; row -= kRows)
    TakeRows<kWidth, kRows>(panel, row - kRows, panel.width, lanes, x);
  for (; row > panel.width; --row)
    TakeRows<kWidth, 1>(panel, row - 1, panel.width, lanes, x);
  while (row-- > 0) {
    Multiply(panel.values + (row * panel.width + row) * lanes, lanes, x + panel.rows[row] * lanes);
    TakeRows<kWidth, 1>(panel, row, row, lanes, x);
  }
}

constexpr int WidthFor(int lanes) {
  return lanes < kWidest ? lanes : kWidest;
}

// The lanes as constants, so that every loop over them unrolls.

static void SubtractProductsEntry(const ProductsView& view, ptrdiff_t lanes) {
  lanes == 4 ? SubtractProducts<WidthFor(4)>(view, 4) : SubtractProducts<WidthFor(8)>(view, 8);
}

static void FactorPanelEntry(double* values, ptrdiff_t num_rows, ptrdiff_t width, ptrdiff_t lanes,
                             bool* definite) {
  if (lanes == 4) {
    FactorPanel<WidthFor(4)>({values, width * 4, 4}, num_rows, width, definite);
  } else {
    FactorPanel<WidthFor(8)>({values, width * 8, 8}, num_rows, width, definite);
  }
}

static void SolveForwardEntry(const PanelView& panel, ptrdiff_t lanes, double* x) {
  lanes == 4 ? SolveForward<WidthFor(4)>(panel, 4, x) : SolveForward<WidthFor(8)>(panel, 8, x);
}

static void SolveBackwardEntry(const PanelView& panel, ptrdiff_t lanes, double* x) {
  lanes == 4 ? SolveBackward<WidthFor(4)>(panel, 4, x) : SolveBackward<WidthFor(8)>(panel, 8, x);
}

static CholeskyKernels MakeTable(const char* name) {
  return {name, SubtractProductsEntry, FactorPanelEntry, SolveForwardEntry, SolveBackwardEntry};
}

#undef LIMBER_INLINE

}  // namespace limber::bake::LIMBER_KERNEL_NAMESPACE
