// The inner loops of an alternation, once for each instruction set. All sets with a
// fused multiply-add (AVX2 and up, 64-bit ARM) give the same bits; the baseline of x86-64 its own.
//
// Layout. Blocks are pairs (group g, shape s), numbered i = g*S + s (or g alone, for the models of
// one shape). Eight blocks make a chunk; what belongs to a block is stored lane by lane:
//     planes   [chunk][row][column][8]   a k x k matrix of every block
// Chunks are full: the lanes past the last block hold zeros (rotations: the identity).
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace limber {

constexpr size_t kBlockLanes = 8;
// Small arrays that are no planes are worked on four numbers at a time.
constexpr size_t kQuadLanes = 4;

// Number of chunks that hold `count` things, and the room that they take. (Always inlined: a copy
// compiled for AVX-512 must not become everyone's, see lanes.h.)
[[gnu::always_inline]] constexpr size_t NumChunks(size_t count) {
  return (count + kBlockLanes - 1) / kBlockLanes;
}

[[gnu::always_inline]] constexpr size_t PaddedSize(size_t count) {
  return NumChunks(count) * kBlockLanes;
}

// Where entry (row, column) of block i's K x K matrix is.
template <int K>
[[gnu::always_inline]] constexpr size_t PlaneIndex(size_t block, size_t row, size_t column) {
  return ((block / kBlockLanes * K + row) * K + column) * kBlockLanes + block % kBlockLanes;
}

// Small K x K matrices outside of planes are row-major: m[row * K + column].
struct SolveKernels {
  const char* instruction_set;

  // y += a x over whole chunks; and the sum of products, in a fixed order.
  void (*add_scaled)(double a, const double* x, size_t chunks, double* y);
  double (*dot)(const double* x, const double* y, size_t chunks);
  // products[r] = the same of row r and x.
  void (*dot_rows)(const double* rows, size_t stride, size_t count, const double* x, size_t chunks,
                   double* products);
  // y += sum_r scales[r] rows[r], rows of `stride` numbers of which the first `chunks` count.
  void (*add_rows)(const double* rows, size_t stride, const double* scales, size_t count,
                   size_t chunks, double* y);

  // product_i += sum_j G_ij m_j^T; strips: of each j the planes G_ij (rows: i's axes, columns:
  // j's) as [chunk][column][row][8], `stride` numbers from one j to the next; blocks: which of them
  // j runs over; m: [count][K][K]; product: planes (row: i's axis).
  void (*add_products)(const double* strips, size_t stride, const int* blocks, const double* m,
                       size_t count, size_t chunks, double* product);
  void (*add_float_products)(const float* strips, size_t stride, const int* blocks, const double* m,
                             size_t count, size_t chunks, double* product);
  // traces[i] = tr(R_i M_i); both planes.
  void (*traces)(const double* rotations, const double* planes, size_t chunks, double* traces);

  // The same matrices one by one: matrices: [j][i][K][K], `stride` numbers from one j to the next;
  // product: [i][K][4] (columns past K mean nothing), of `num_blocks` blocks i.
  void (*add_single_products)(const double* matrices, size_t stride, const int* blocks,
                              const double* m, size_t count, size_t num_blocks, double* product);
  // entries[n] = tr(R_i G_i R_j^T), i = blocks[n]; matrices: [i][K][K] of one j; columns: those of
  // R_i, [i][K][4] with zeros past K; turn: those of R_j.
  void (*turned_entries)(const double* matrices, const double* columns, const double* turn,
                         const int* blocks, size_t count, double* entries);
  // out(c, :) += sum_a m(c, a) rows(a, :); both [K][4 quads].
  void (*add_turned_rows)(const double* m, const double* rows, size_t quads, double* out);

  // rows[(p*K + c)][i] = sum_a R_i(c, a) loads_i(a, p); loads: [chunk][a][pins][8].
  void (*rotate_loads)(const double* loads, const double* rotations, size_t pins, size_t chunks,
                       double* rows);
  // product_i(a, c) += sum_p loads_i(a, p) values(c, p); values: [K][stride].
  void (*add_loads)(const double* loads, const double* values, size_t pins, size_t stride,
                    size_t chunks, double* product);

  // R_i = argmax tr(R fits_i) near the R_i given (warm start, and the choice where several serve
  // equally); fits, rotations: planes. failed[i] != 0: too far from the start, R_i is as it was.
  void (*fit_rotations)(const double* fits, double* rotations, size_t chunks, uint8_t* failed);

  // changes[i] = |R_i - R'_i| (Frobenius); rotations, others: planes.
  void (*rotation_changes)(const double* rotations, const double* others, size_t chunks,
                           double* changes);

  // A model of one shape: z = sum_g sum_a edges(g, a, :) R_g(:, a)^T; edges: [groups][K][stride];
  // rotations: planes over groups; z: [K][stride] with a stride of 8 mode_chunks.
  void (*single_modes)(const float* edges, const double* rotations, size_t groups,
                       size_t mode_chunks, double* modes);
  // fits_g(a, c) = sum_m edges(m, a, g) z(m, c); edges: [group chunk][modes][K][8];
  // z: [K][stride].
  void (*single_fits)(const float* edges, const double* modes, size_t num_modes, size_t stride,
                      size_t chunks, double* fits);
  // |U x|^2 for one block, U upper triangular, size x size; x: [K][stride]. head: the first eight
  // rows of U, [column][8]; tail: eight rows after eight rows of the others, of each its columns
  // from the first row's own on. Goes on from *rows_done rows, whose energies are in squares, [8],
  // until their sum is at_least or all rows are done; returns the sum.
  double (*single_energy)(const float* head, const float* tail, const double* x, size_t size,
                          size_t stride, double at_least, size_t* rows_done, double* squares);

  // out(:, c) += sum_j sum_b table_j(b, :) m_j(c, b); tables: [chunk][K][8] each, one after the
  // other; blocks: which of them j runs over; m: [count][K][K]; out: [chunk][K][8].
  void (*add_transforms)(const float* tables, const int* blocks, const double* m, size_t count,
                         size_t chunks, double* out);

  // In place, a = L L^T, column-major with columns of `stride` (a multiple of 8) doubles, the part
  // below the diagonal read and overwritten. Pivots that are not positive are raised to the
  // smallest that is.
  void (*cholesky_factor)(double* a, size_t size, size_t stride);
  // x: in the right side, out the solution of L L^T x = b; room for `stride` numbers, of which
  // those past `size` are zero.
  void (*cholesky_solve)(const double* l, size_t size, size_t stride, double* x);
};

// The widest set that this machine has, for k = 2 and 3.
template <int K>
const SolveKernels& ChooseSolveKernels();

// All sets that this machine has, narrowest first; ends with null. For tests.
template <int K>
const SolveKernels* const* AvailableSolveKernels();

}  // namespace limber
