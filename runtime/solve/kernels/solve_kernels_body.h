// The code of solve_kernels.h. Included by one source file for each instruction set, which defines
// LIMBER_KERNEL_NAMESPACE; see lanes.h for why nothing here may be shared between them.
#pragma once

#include "solve/kernels/lanes.h"
#include "solve/kernels/solve_kernels.h"

namespace limber::LIMBER_KERNEL_NAMESPACE {

// Where lane `at` (of all chunks) begins in arrays of `planes` numbers a lane.
static inline __attribute__((always_inline)) size_t Offset(size_t at, size_t planes) {
  return at / kLanes * planes * kLanes + at % kLanes;
}

static void AddScaled(double a, const double* x, size_t chunks, double* y) {
  const Lanes scale = Splat(a);
  for (size_t at = 0; at < chunks * kLanes; at += kWidth)
    Store(MulAdd(scale, Load(x + at), Load(y + at)), y + at);
}

static double Dot(const double* x, const double* y, size_t chunks) {
  Lanes sums[kChunkParts] = {};
  for (size_t at = 0; at < chunks * kLanes; at += kLanes) {
    for (size_t part = 0; part < kChunkParts; ++part) {
      sums[part] = MulAdd(Load(x + at + part * kWidth), Load(y + at + part * kWidth), sums[part]);
    }
  }
  return Sum(sums);
}

static void DotRows(const double* rows, size_t stride, size_t count, const double* x, size_t chunks,
                    double* products) {
  for (size_t r = 0; r < count; ++r)
    products[r] = Dot(rows + r * stride, x, chunks);
}

// Parts of y that stay in registers while the rows pass by.
template <size_t kParts>
static inline __attribute__((always_inline)) void AddRowsAt(const double* rows, size_t stride,
                                                            const double* scales, size_t count,
                                                            double* y) {
  Lanes sums[kParts];
  for (size_t part = 0; part < kParts; ++part)
    sums[part] = Load(y + part * kWidth);
  for (size_t r = 0; r < count; ++r, rows += stride) {
    const Lanes scale = Splat(scales[r]);
    for (size_t part = 0; part < kParts; ++part)
      sums[part] = MulAdd(scale, Load(rows + part * kWidth), sums[part]);
  }
  for (size_t part = 0; part < kParts; ++part)
    Store(sums[part], y + part * kWidth);
}

static void AddRows(const double* rows, size_t stride, const double* scales, size_t count,
                    size_t chunks, double* y) {
  const size_t end = chunks * kLanes;
  size_t at = 0;
  for (; at + 8 * kWidth <= end; at += 8 * kWidth)
    AddRowsAt<8>(rows + at, stride, scales, count, y + at);
  if (at + 4 * kWidth <= end) {
    AddRowsAt<4>(rows + at, stride, scales, count, y + at);
    at += 4 * kWidth;
  }
  if (at + 2 * kWidth <= end) {
    AddRowsAt<2>(rows + at, stride, scales, count, y + at);
    at += 2 * kWidth;
  }
  if (at < end) AddRowsAt<1>(rows + at, stride, scales, count, y + at);
}

// A K x K matrix (row-major) with each entry in all lanes.
template <int K>
struct SplatMatrix {
  Lanes at[K][K];

  explicit SplatMatrix(const double* m) {
    for (size_t row = 0; row < K; ++row) {
      for (size_t column = 0; column < K; ++column)
        at[row][column] = Splat(m[row * K + column]);
    }
  }

  __attribute__((always_inline)) const Lanes& operator()(size_t row, size_t column) const {
    return at[row][column];
  }
};

// out(:, c) += sum_b table(b, :) weight(c, b) over `count` entries b, `step` numbers apart.
template <int K, typename Number, typename Weight>
static inline __attribute__((always_inline)) void AddRow(const Number* table, size_t step,
                                                         size_t count, const Weight& weight,
                                                         double* out) {
  Lanes sum[K];
  for (size_t c = 0; c < K; ++c)
    sum[c] = Load(out + c * kLanes);
  for (size_t b = 0; b < count; ++b) {
    const Lanes entry = Load(table + b * step);
    for (size_t c = 0; c < K; ++c)
      sum[c] = MulAdd(entry, weight(c, b), sum[c]);
  }
  for (size_t c = 0; c < K; ++c)
    Store(sum[c], out + c * kLanes);
}

// Chunks that are worked on at a time, so that the product stays in the nearest cache while pieces
// of the strips, each long enough for memory to like it, pass by.
constexpr size_t kProductTile = 32;

template <int K, typename Number>
static void AddProducts(const Number* strips, size_t stride, const int* blocks, const double* m,
                        size_t count, size_t chunks, double* product) {
  for (size_t first = 0; first < chunks; first += kProductTile) {
    const size_t end = first + kProductTile < chunks ? first + kProductTile : chunks;
    for (size_t j = 0; j < count; ++j) {
      const SplatMatrix<K> matrix(m + j * K * K);
      const Number* strip = strips + static_cast<size_t>(blocks[j]) * stride;
      for (size_t at = first * kLanes; at < end * kLanes; at += kWidth) {
        const Number* from = strip + Offset(at, size_t{K} * K);
        double* to = product + Offset(at, size_t{K} * K);
        for (size_t a = 0; a < K; ++a)
          AddRow<K>(from + a * kLanes, K * kLanes, K, matrix, to + a * K * kLanes);
      }
    }
  }
}

template <int K>
static void Traces(const double* rotations, const double* planes, size_t chunks, double* traces) {
  for (size_t at = 0; at < chunks * kLanes; at += kWidth) {
    const double* rotation = rotations + Offset(at, size_t{K} * K);
    const double* plane = planes + Offset(at, size_t{K} * K);
    Lanes sum = {};
    for (size_t c = 0; c < K; ++c) {
      for (size_t a = 0; a < K; ++a)
        sum =
            MulAdd(Load(rotation + (c * K + a) * kLanes), Load(plane + (a * K + c) * kLanes), sum);
    }
    Store(sum, traces + at);
  }
}

template <int K>
static void AddSingleProducts(const double* matrices, size_t stride, const int* blocks,
                              const double* m, size_t count, size_t num_blocks, double* product) {
  for (size_t j = 0; j < count; ++j, m += K * K) {
    double columns[K * kQuadWidth] = {};  // of m
    for (size_t b = 0; b < K; ++b) {
      for (size_t c = 0; c < K; ++c)
        columns[b * kQuadWidth + c] = m[c * K + b];
    }
    const double* matrix = matrices + static_cast<size_t>(blocks[j]) * stride;
    double* out = product;
    for (size_t i = 0; i < num_blocks * K; ++i, matrix += K, out += kQuadWidth) {
      Quad sum = LoadQuad(out);
      for (size_t b = 0; b < K; ++b)
        sum = MulAdd(matrix[b], LoadQuad(columns + b * kQuadWidth), sum);
      StoreQuad(sum, out);
    }
  }
}

// Matrices that are fetched ahead: they lie far apart.
constexpr size_t kMatricesAhead = 12;

template <int K>
static void TurnedEntries(const double* matrices, const double* columns, const double* turn,
                          const int* blocks, size_t count, double* entries) {
  Quad turned[K];
  for (size_t b = 0; b < K; ++b)
    turned[b] = LoadQuad(turn + b * kQuadWidth);
  for (size_t n = 0; n < count; ++n) {
    if (n + kMatricesAhead < count) {
      const double* ahead = matrices + static_cast<size_t>(blocks[n + kMatricesAhead]) * (K * K);
      __builtin_prefetch(ahead);
      __builtin_prefetch(ahead + K * K - 1);
    }
    const double* matrix = matrices + static_cast<size_t>(blocks[n]) * (K * K);
    const double* column = columns + static_cast<size_t>(blocks[n]) * (K * kQuadWidth);
    Quad sum = {};
    for (size_t a = 0; a < K; ++a, matrix += K) {
      Quad row = {};
      for (size_t b = 0; b < K; ++b)
        row = MulAdd(matrix[b], turned[b], row);
      sum = MulAdd(LoadQuad(column + a * kQuadWidth), row, sum);
    }
    entries[n] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
}

template <int K>
static void AddTurnedRows(const double* m, const double* rows, size_t quads, double* out) {
  const size_t stride = quads * kQuadWidth;
  for (size_t at = 0; at < stride; at += kQuadWidth) {
    for (size_t c = 0; c < K; ++c) {
      Quad sum = LoadQuad(out + c * stride + at);
      for (size_t a = 0; a < K; ++a)
        sum = MulAdd(m[c * K + a], LoadQuad(rows + a * stride + at), sum);
      StoreQuad(sum, out + c * stride + at);
    }
  }
}

template <int K>
static void AddTransforms(const float* tables, const int* blocks, const double* m, size_t count,
                          size_t chunks, double* out) {
  constexpr size_t kTile = kProductTile * K;  // rows are so much smaller
  for (size_t first = 0; first < chunks; first += kTile) {
    const size_t end = first + kTile < chunks ? first + kTile : chunks;
    for (size_t j = 0; j < count; ++j) {
      const SplatMatrix<K> matrix(m + j * K * K);
      const float* table = tables + static_cast<size_t>(blocks[j]) * chunks * (K * kLanes);
      for (size_t at = first * kLanes; at < end * kLanes; at += kWidth)
        AddRow<K>(table + Offset(at, K), kLanes, K, matrix, out + Offset(at, K));
    }
  }
}

template <int K>
static void RotationChanges(const double* rotations, const double* others, size_t chunks,
                            double* changes) {
  for (size_t at = 0; at < chunks * kLanes; at += kWidth) {
    const size_t offset = Offset(at, size_t{K} * K);
    Lanes sum = {};
    for (size_t entry = 0; entry < size_t{K} * K; ++entry) {
      const Lanes change =
          Load(rotations + offset + entry * kLanes) - Load(others + offset + entry * kLanes);
      sum = MulAdd(change, change, sum);
    }
    Store(SquareRoot(sum), changes + at);
  }
}

template <int K>
static void RotateLoads(const double* loads, const double* rotations, size_t pins, size_t chunks,
                        double* rows) {
  for (size_t at = 0; at < chunks * kLanes; at += kWidth) {
    const double* load = loads + Offset(at, K * pins);
    const double* rotation = rotations + Offset(at, size_t{K} * K);
    for (size_t c = 0; c < K; ++c) {
      for (size_t p = 0; p < pins; ++p) {
        Lanes sum = {};
        for (size_t a = 0; a < K; ++a)
          sum = MulAdd(Load(rotation + (c * K + a) * kLanes), Load(load + (a * pins + p) * kLanes),
                       sum);
        Store(sum, rows + (p * K + c) * chunks * kLanes + at);
      }
    }
  }
}

template <int K>
static void AddLoads(const double* loads, const double* values, size_t pins, size_t stride,
                     size_t chunks, double* product) {
  for (size_t at = 0; at < chunks * kLanes; at += kWidth) {
    const double* load = loads + Offset(at, K * pins);
    double* out = product + Offset(at, size_t{K} * K);
    const auto value = [=](size_t c, size_t p) { return Splat(values[c * stride + p]); };
    for (size_t a = 0; a < K; ++a, load += pins * kLanes, out += K * kLanes)
      AddRow<K>(load, kLanes, pins, value, out);
  }
}

// kParts times kWidth modes at once, whose sums hide each other's latency.
template <int K, size_t kParts>
static inline __attribute__((always_inline)) void SingleModesAt(const float* edges,
                                                                const double* rotations,
                                                                size_t groups, size_t stride,
                                                                double* modes) {
  Lanes sum[kParts][K] = {};
  for (size_t g = 0; g < groups; ++g) {
    for (size_t a = 0; a < K; ++a, edges += stride) {
      for (size_t part = 0; part < kParts; ++part) {
        const Lanes edge = Load(edges + part * kWidth);
        for (size_t c = 0; c < K; ++c)
          sum[part][c] = MulAdd(edge, Splat(rotations[PlaneIndex<K>(g, c, a)]), sum[part][c]);
      }
    }
  }
  for (size_t part = 0; part < kParts; ++part) {
    for (size_t c = 0; c < K; ++c)
      Store(sum[part][c], modes + c * stride + part * kWidth);
  }
}

template <int K>
static void SingleModes(const float* edges, const double* rotations, size_t groups,
                        size_t mode_chunks, double* modes) {
  const size_t stride = mode_chunks * kLanes;
  size_t at = 0;
  for (; at + 4 * kWidth <= stride; at += 4 * kWidth)
    SingleModesAt<K, 4>(edges + at, rotations, groups, stride, modes + at);
  if (at + 2 * kWidth <= stride) {
    SingleModesAt<K, 2>(edges + at, rotations, groups, stride, modes + at);
    at += 2 * kWidth;
  }
  if (at < stride) SingleModesAt<K, 1>(edges + at, rotations, groups, stride, modes + at);
}

template <int K>
static void SingleFits(const float* edges, const double* modes, size_t num_modes, size_t stride,
                       size_t chunks, double* fits) {
  for (size_t at = 0; at < chunks * kLanes; at += kWidth) {
    const float* edge = edges + Offset(at, num_modes * K);
    double* out = fits + Offset(at, size_t{K} * K);
    Lanes sum[K][K] = {};
    for (size_t m = 0; m < num_modes; ++m, edge += K * kLanes) {
      for (size_t a = 0; a < K; ++a) {
        const Lanes entry = Load(edge + a * kLanes);
        for (size_t c = 0; c < K; ++c)
          sum[a][c] = MulAdd(entry, Splat(modes[c * stride + m]), sum[a][c]);
      }
    }
    for (size_t a = 0; a < K; ++a) {
      for (size_t c = 0; c < K; ++c)
        Store(sum[a][c], out + (a * K + c) * kLanes);
    }
  }
}

// sums += column of a factor times x's row, of K numbers `stride` apart. Each number is loaded
// where it is used: with all of them in registers there would not be enough for the sums.
template <int K>
static inline __attribute__((always_inline)) void AddColumn(const float* column, const double* x,
                                                            size_t stride,
                                                            Lanes (&sums)[K][kChunkParts]) {
  Lanes entries[kChunkParts];
  for (size_t part = 0; part < kChunkParts; ++part)
    entries[part] = Load(column + part * kWidth);
  for (size_t c = 0; c < K; ++c) {
    const Lanes number = Splat(x[c * stride]);
    for (size_t part = 0; part < kChunkParts; ++part)
      sums[c][part] = MulAdd(entries[part], number, sums[c][part]);
  }
}

// Numbers that factors are fetched ahead: they are walked in the order of memory, but only a few
// thousand bytes at a time, which the hardware's own guess is too slow for.
constexpr size_t kFactorAhead = 768;

// Adds the squares of rows 0 to 7 of a factor times x, columns in pairs that hide each other's
// latency.
template <int K>
static inline __attribute__((always_inline)) void AddRowSquares(const float* factor,
                                                                const double* x, size_t columns,
                                                                size_t stride,
                                                                Lanes (&squares)[kChunkParts]) {
  Lanes even[K][kChunkParts] = {}, odd[K][kChunkParts] = {};
  for (; columns >= 2; columns -= 2, factor += 2 * kLanes, x += 2) {
    __builtin_prefetch(factor + kFactorAhead);
    AddColumn<K>(factor, x, stride, even);
    AddColumn<K>(factor + kLanes, x + 1, stride, odd);
  }
  if (columns != 0) AddColumn<K>(factor, x, stride, even);
  for (size_t part = 0; part < kChunkParts; ++part) {
    for (size_t c = 0; c < K; ++c) {
      const Lanes sum = even[c][part] + odd[c][part];
      squares[part] = MulAdd(sum, sum, squares[part]);
    }
  }
}

template <int K>
static double SingleEnergy(const float* head, const float* tail, const double* x, size_t size,
                           size_t stride, double at_least, size_t* rows_done, double* squares) {
  size_t first = *rows_done;
  for (size_t row = kLanes; row < first; row += kLanes)
    tail += (size - row) * kLanes;
  Lanes sums[kChunkParts];
  for (size_t part = 0; part < kChunkParts; ++part)
    sums[part] = Load(squares + part * kWidth);
  // No partial sum reaches infinity, and none is looked at.
  const bool in_parts = at_least <= 1e300;
  while (first < size && !(in_parts && Sum(sums) >= at_least)) {
    AddRowSquares<K>(first == 0 ? head : tail, x + first, size - first, stride, sums);
    if (first != 0) tail += (size - first) * kLanes;
    first += kLanes;
  }
  *rows_done = first;
  for (size_t part = 0; part < kChunkParts; ++part)
    Store(sums[part], squares + part * kWidth);
  return Sum(sums);
}

// Left-looking, column by column: the inner loop runs down a column. Rows above the diagonal that
// share its chunk are computed along and set to zero.
static void CholeskyFactor(double* a, size_t size, size_t stride) {
  for (size_t j = 0; j < size; ++j) {
    double* column = a + j * stride;
    const double before = column[j];
    const size_t first = j / kLanes * kLanes;
    for (size_t m = 0; m < j; ++m) {
      const double* other = a + m * stride;
      AddScaled(-other[j], other + first, (stride - first) / kLanes, column + first);
    }
    const double smallest = 1e-15 * (before < 0 ? -before : before) + 1e-300;
    const double pivot = __builtin_sqrt(column[j] > smallest ? column[j] : smallest);
    const double inverse = 1 / pivot;
    for (size_t i = first; i < stride; i += kWidth)
      Store(Load(column + i) * inverse, column + i);
    column[j] = pivot;
    for (size_t i = first; i < j; ++i)
      column[i] = 0;
    for (size_t i = size; i < stride; ++i)
      column[i] = 0;
  }
}

static void CholeskySolve(const double* l, size_t size, size_t stride, double* x) {
  for (size_t j = 0; j < size; ++j) {
    const double* column = l + j * stride;
    const double value = x[j] / column[j];
    const size_t first = j / kLanes * kLanes;
    AddScaled(-value, column + first, (stride - first) / kLanes, x + first);
    x[j] = value;
  }
  for (size_t j = size; j-- > 0;) {
    const double* column = l + j * stride;
    const size_t first = j / kLanes * kLanes;
    const double value = x[j];
    x[j] = 0;
    x[j] = (value - Dot(column + first, x + first, (stride - first) / kLanes)) / column[j];
  }
}

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
