// The kernels themselves. Included only by the files that compile them, once for each instruction
// set; so nothing here has external linkage, and nothing of the standard library is inlined from
// here (a copy compiled for AVX-512 could be the one that the linker keeps for everyone).
#pragma once

#include "linear/panel_kernels/panel_kernels.h"
#include "linear/panel_kernels/row_blocks.h"

namespace limber::linear::LIMBER_KERNEL_NAMESPACE {

// Where the rows of one block go in the panel that products are taken from.
struct BlockPlaces {
  int first, end;  // rows of the block that go anywhere
  // Where they follow each other there (is_run), row 0 would be row `shift` of the block at `low`,
  // and those past its end go to `high`; null where a block gets none.
  double *low, *high;
  ptrdiff_t offset[kBlockRows];  // else, of each row
  int shift;
  bool is_run;
};

LIMBER_INLINE bool AreConsecutive(const int* places, int first, int end) {
  for (int r = first + 1; r < end; ++r) {
    if (places[r] != places[r - 1] + 1) return false;
  }
  return true;
}

LIMBER_INLINE void FindPlaces(const ProductsView& view, ptrdiff_t block, BlockPlaces* to) {
  const ptrdiff_t row = block * kBlockRows;
  to->first = view.begin > row ? (int)(view.begin - row) : 0;
  to->end = view.from.num_rows < row + kBlockRows ? (int)(view.from.num_rows - row) : kBlockRows;
  int places[kBlockRows];
  for (int r = to->first; r < to->end; ++r)
    places[r] = view.local[view.from.rows[row + r]];
  const ptrdiff_t block_step = view.to_width * kBlockRows;
  to->is_run = kHasMasks && AreConsecutive(places, to->first, to->end);
  if (!to->is_run) {
    for (int r = to->first; r < to->end; ++r)
      to->offset[r] = places[r] / kBlockRows * block_step + places[r] % kBlockRows;
    return;
  }
  const int start = places[to->first] - to->first;  // of row 0, perhaps before the panel
  const int low = (start + kBlockRows) / kBlockRows - 1;
  to->shift = start - low * kBlockRows;
  to->low = to->shift + to->first < kBlockRows ? view.to + low * block_step : nullptr;
  to->high = to->shift + to->end > kBlockRows ? view.to + (low + 1) * block_step : nullptr;
}

// Adds a block's rows of some columns. column: doubles from the first column of a block.
template <int kColumns>
LIMBER_INLINE void AddColumns(const Block* sums, const BlockPlaces& to, const ptrdiff_t* column,
                              double* panel) {
  if (to.is_run) {
    const unsigned rows = (1U << to.end) - (1U << to.first);
    const unsigned in_low = 0xFFU >> to.shift;
    if (to.low != nullptr) {
      LIMBER_UNROLL
      for (int c = 0; c < kColumns; ++c)
        AddRows(sums[c], rows & in_low, to.low + column[c] + to.shift);
    }
    if (to.high != nullptr) {
      LIMBER_UNROLL
      for (int c = 0; c < kColumns; ++c)
        AddRows(sums[c], rows & ~in_low, to.high + column[c] + to.shift - kBlockRows);
    }
    return;
  }
  LIMBER_UNROLL
  for (int c = 0; c < kColumns; ++c) {
    double numbers[kBlockRows];
    StoreBlock(sums[c], numbers);
    for (int r = to.first; r < to.end; ++r)
      panel[to.offset[r] + column[c]] += numbers[r];
  }
}

// Of kBlocks blocks from `block` on with kColumns rows of the panel from `row` on, which are
// columns there.
template <int kBlocks, int kColumns>
LIMBER_INLINE void UpdateTile(const ProductsView& view, ptrdiff_t block, ptrdiff_t row,
                              const BlockPlaces* to) {
  Block sums[kBlocks][kColumns];
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b) {
    LIMBER_UNROLL
    for (int c = 0; c < kColumns; ++c)
      sums[b][c] = Zero();
  }
  const Panel panel{view.from.values, view.from.width};
  SubtractProductsOf<kBlocks, kColumns>(panel, block, panel, row, view.from.width, sums);
  ptrdiff_t column[kColumns];
  LIMBER_UNROLL
  for (int c = 0; c < kColumns; ++c)
    column[c] = (view.from.rows[row + c] - view.to_first) * kBlockRows;
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b)
    AddColumns<kColumns>(sums[b], to[b], column, view.to);
}

template <int kBlocks>
LIMBER_INLINE void UpdateBlocks(const ProductsView& view, ptrdiff_t block) {
  BlockPlaces to[kBlocks];
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b)
    FindPlaces(view, block + b, &to[b]);
  const ptrdiff_t end_row = (block + kBlocks) * kBlockRows;
  const ptrdiff_t end = view.end < end_row ? view.end : end_row;
  ptrdiff_t row = view.begin;
  for (; row + kTileColumns <= end; row += kTileColumns)
    UpdateTile<kBlocks, kTileColumns>(view, block, row, to);
  if (kTileColumns > 2 && end - row >= 2) {
    UpdateTile<kBlocks, 2>(view, block, row, to);
    row += 2;
  }
  if (end - row >= 1) UpdateTile<kBlocks, 1>(view, block, row, to);
}

static void SubtractProducts(const ProductsView& view) {
  const ptrdiff_t num_blocks = NumBlocks(view.from.num_rows);
  ptrdiff_t block = view.begin / kBlockRows;
  for (; block + kTileBlocks <= num_blocks; block += kTileBlocks)
    UpdateBlocks<kTileBlocks>(view, block);
  if (kTileBlocks > 2 && num_blocks - block >= 2) {
    UpdateBlocks<2>(view, block);
    block += 2;
  }
  for (; block < num_blocks; ++block)
    UpdateBlocks<1>(view, block);
}

// One over the root of a pivot where that is positive, else one, and *definite = false.
LIMBER_INLINE double InverseRoot(double pivot, bool* definite) {
  if (pivot > 0) return 1 / __builtin_sqrt(pivot);
  *definite = false;
  return 1;
}

// kColumns columns from `column` on, of the block that holds their pivots.
template <int kColumns>
LIMBER_INLINE void FactorPivots(double* values, ptrdiff_t width, ptrdiff_t column, bool* definite) {
  const ptrdiff_t block = column / kBlockRows;
  const int pivot = (int)(column % kBlockRows);
  double* place = values + (block * width + column) * kBlockRows;
  Block sums[1][kColumns];
  LIMBER_UNROLL
  for (int c = 0; c < kColumns; ++c)
    sums[0][c] = LoadBlock(place + c * kColumnStep);
  const Panel panel{values, width};
  SubtractProductsOf<1, kColumns>(panel, block, panel, column, column, sums);
  LIMBER_UNROLL
  for (int c = 0; c < kColumns; ++c) {
    for (int k = 0; k < c; ++k)
      sums[0][c] = MulSub(sums[0][k], place[k * kColumnStep + pivot + c], sums[0][c]);
    double* numbers = place + c * kColumnStep;
    StoreBlock(sums[0][c], numbers);
    const double inverse = InverseRoot(numbers[pivot + c], definite);
    sums[0][c] = Product(sums[0][c], inverse);
    StoreBlock(sums[0][c], numbers);
    for (int r = 0; r < pivot + c; ++r)
      numbers[r] = 0;
    numbers[pivot + c] = inverse;
  }
}

// The same columns of kBlocks blocks further down.
template <int kBlocks, int kColumns>
LIMBER_INLINE void SolveTile(double* values, ptrdiff_t width, ptrdiff_t column, ptrdiff_t block) {
  const double* pivots = values + (column / kBlockRows * width + column) * kBlockRows;
  const int pivot = (int)(column % kBlockRows);
  Block sums[kBlocks][kColumns];
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b) {
    LIMBER_UNROLL
    for (int c = 0; c < kColumns; ++c)
      sums[b][c] = LoadBlock(values + ((block + b) * width + column + c) * kBlockRows);
  }
  const Panel panel{values, width};
  SubtractProductsOf<kBlocks, kColumns>(panel, block, panel, column, column, sums);
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b) {
    LIMBER_UNROLL
    for (int c = 0; c < kColumns; ++c) {
      for (int k = 0; k < c; ++k)
        sums[b][c] = MulSub(sums[b][k], pivots[k * kColumnStep + pivot + c], sums[b][c]);
      sums[b][c] = Product(sums[b][c], pivots[c * kColumnStep + pivot + c]);
      StoreBlock(sums[b][c], values + ((block + b) * width + column + c) * kBlockRows);
    }
  }
}

template <int kColumns>
LIMBER_INLINE void FactorColumns(double* values, ptrdiff_t num_blocks, ptrdiff_t width,
                                 ptrdiff_t column, bool* definite) {
  FactorPivots<kColumns>(values, width, column, definite);
  ptrdiff_t block = column / kBlockRows + 1;
  for (; block + kTileBlocks <= num_blocks; block += kTileBlocks)
    SolveTile<kTileBlocks, kColumns>(values, width, column, block);
  for (; block < num_blocks; ++block)
    SolveTile<1, kColumns>(values, width, column, block);
}

static bool FactorPanel(double* values, ptrdiff_t num_rows, ptrdiff_t width) {
  bool definite = true;
  ptrdiff_t column = 0;
  for (; column + kTileColumns <= width; column += kTileColumns)
    FactorColumns<kTileColumns>(values, NumBlocks(num_rows), width, column, &definite);
  for (; column < width; ++column)
    FactorColumns<1>(values, NumBlocks(num_rows), width, column, &definite);
  return definite;
}

// A block's rows of x, zero beyond the last.
LIMBER_INLINE Block Gather(const PanelView& panel, ptrdiff_t block, const double* x) {
  double numbers[kBlockRows] = {};
  const ptrdiff_t row = block * kBlockRows;
  for (ptrdiff_t r = 0; r < kBlockRows && row + r < panel.num_rows; ++r)
    numbers[r] = x[panel.rows[row + r]];
  return LoadBlock(numbers);
}

// From row `first` of the block on.
LIMBER_INLINE void Scatter(const Block& sums, const PanelView& panel, ptrdiff_t block, int first,
                           double* x) {
  double numbers[kBlockRows];
  StoreBlock(sums, numbers);
  const ptrdiff_t row = block * kBlockRows;
  for (ptrdiff_t r = first; r < kBlockRows && row + r < panel.num_rows; ++r)
    x[panel.rows[row + r]] = numbers[r];
}

// Rows of x, less their products with the first `count` numbers of y.
template <int kBlocks>
LIMBER_INLINE void SubtractFromRows(const PanelView& panel, ptrdiff_t block, ptrdiff_t count,
                                    const double* y, double* x) {
  Block sums[kBlocks];
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b)
    sums[b] = Gather(panel, block + b, x);
  const double* values = panel.values + block * panel.width * kBlockRows;
  for (ptrdiff_t k = 0; k < count; ++k) {
    LIMBER_UNROLL
    for (int b = 0; b < kBlocks; ++b)
      sums[b] = MulSub(LoadBlock(values + (b * panel.width + k) * kBlockRows), y[k], sums[b]);
  }
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b)
    Scatter(sums[b], panel, block + b, 0, x);
}

// The columns whose pivots lie in this block; the rows below them in it take part.
LIMBER_INLINE void SolveInBlock(const PanelView& panel, ptrdiff_t block, double* x) {
  const ptrdiff_t first = block * kBlockRows;
  const int count = panel.width - first < kBlockRows ? (int)(panel.width - first) : kBlockRows;
  const double* values = panel.values + (block * panel.width + first) * kBlockRows;
  double* y = x + panel.rows[0] + first;
  Block sums = Gather(panel, block, x);
  double numbers[kBlockRows];
  for (int k = 0; k < count; ++k) {
    StoreBlock(sums, numbers);
    y[k] = numbers[k] * values[k * kColumnStep + k];
    sums = MulSub(LoadBlock(values + k * kColumnStep), y[k], sums);
  }
  Scatter(sums, panel, block, count, x);
}

static void SolveForward(const PanelView& panel, double* x) {
  const double* y = x + panel.rows[0];
  ptrdiff_t block = 0;
  for (; block * kBlockRows < panel.width; ++block) {
    SubtractFromRows<1>(panel, block, block * kBlockRows, y, x);
    SolveInBlock(panel, block, x);
  }
  const ptrdiff_t num_blocks = NumBlocks(panel.num_rows);
  for (; block + 4 <= num_blocks; block += 4)
    SubtractFromRows<4>(panel, block, panel.width, y, x);
  for (; block < num_blocks; ++block)
    SubtractFromRows<1>(panel, block, panel.width, y, x);
}

// sums[k] -= the products of kBlocks blocks of column k with their rows of x.
template <int kBlocks>
LIMBER_INLINE void SubtractFromColumns(const PanelView& panel, ptrdiff_t block, const Block* x,
                                       double* sums) {
  const double* values = panel.values + block * panel.width * kBlockRows;
  for (ptrdiff_t k = 0; k < panel.width; ++k) {
    Block sum = LoadBlock(sums + k * kColumnStep);
    LIMBER_UNROLL
    for (int b = 0; b < kBlocks; ++b)
      sum = MulSub(LoadBlock(values + (b * panel.width + k) * kBlockRows), x[b], sum);
    StoreBlock(sum, sums + k * kColumnStep);
  }
}

template <int kBlocks>
LIMBER_INLINE void TakeRowsBelow(const PanelView& panel, ptrdiff_t block, const double* x,
                                 double* sums) {
  Block rows[kBlocks];
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b) {
    rows[b] = Gather(panel, block + b, x);
    if ((block + b) * kBlockRows >= panel.width) continue;
    double numbers[kBlockRows];  // without the rows of the triangle
    StoreBlock(rows[b], numbers);
    for (int r = 0; r < kBlockRows && (block + b) * kBlockRows + r < panel.width; ++r)
      numbers[r] = 0;
    rows[b] = LoadBlock(numbers);
  }
  SubtractFromColumns<kBlocks>(panel, block, rows, sums);
}

static void SolveBackward(const PanelView& panel, double* x) {
  double sums[kWidestPanel * kBlockRows];
  for (ptrdiff_t k = 0; k < panel.width; ++k)
    StoreBlock(Zero(), sums + k * kColumnStep);
  const ptrdiff_t num_blocks = NumBlocks(panel.num_rows);
  ptrdiff_t block = panel.width / kBlockRows;
  for (; block + 4 <= num_blocks; block += 4)
    TakeRowsBelow<4>(panel, block, x, sums);
  for (; block < num_blocks; ++block)
    TakeRowsBelow<1>(panel, block, x, sums);
  double* y = x + panel.rows[0];
  for (ptrdiff_t k = 0; k < panel.width; ++k) {
    const double* sum = sums + k * kColumnStep;
    y[k] += ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
  }
  for (ptrdiff_t row = panel.width - 1; row >= 0; --row) {
    const double* values =
        panel.values + row / kBlockRows * panel.width * kBlockRows + row % kBlockRows;
    y[row] *= values[row * kBlockRows];
    for (ptrdiff_t k = 0; k < row; ++k)
      y[k] -= values[k * kColumnStep] * y[row];
  }
}

template <int kBlocks, int kColumns>
LIMBER_INLINE void AddTile(const AddView& view, ptrdiff_t block, ptrdiff_t column) {
  Block sums[kBlocks][kColumns];
  double* to = view.to + column * view.to_step + block * kBlockRows;
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b) {
    LIMBER_UNROLL
    for (int c = 0; c < kColumns; ++c)
      sums[b][c] = Zero();
  }
  const Panel a{view.a, view.width}, rows{view.b, view.width};
  SubtractProductsOf<kBlocks, kColumns>(a, block, rows, column, view.width, sums);
  LIMBER_UNROLL
  for (int b = 0; b < kBlocks; ++b) {
    LIMBER_UNROLL
    for (int c = 0; c < kColumns; ++c) {
      double* place = to + c * view.to_step + b * kColumnStep;
      StoreBlock(Difference(LoadBlock(place), sums[b][c]), place);
    }
  }
}

template <int kBlocks>
LIMBER_INLINE void AddBlocks(const AddView& view, ptrdiff_t block) {
  const ptrdiff_t end_row = (block + kBlocks) * kBlockRows;
  const ptrdiff_t end = view.only_lower && end_row < view.num_columns ? end_row : view.num_columns;
  ptrdiff_t column = 0;
  for (; column + kTileColumns <= end; column += kTileColumns)
    AddTile<kBlocks, kTileColumns>(view, block, column);
  for (; column < end; ++column)
    AddTile<kBlocks, 1>(view, block, column);
}

static void AddProducts(const AddView& view) {
  ptrdiff_t block = 0;
  for (; block + kTileBlocks <= view.num_blocks; block += kTileBlocks)
    AddBlocks<kTileBlocks>(view, block);
  for (; block < view.num_blocks; ++block)
    AddBlocks<1>(view, block);
}

static PanelKernels MakeTable(const char* name) {
  return {name, AddProducts, SubtractProducts, FactorPanel, SolveForward, SolveBackward};
}

#undef LIMBER_INLINE
#undef LIMBER_UNROLL

}  // namespace limber::linear::LIMBER_KERNEL_NAMESPACE
