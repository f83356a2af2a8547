// The inner loops of LaneCholesky: dense blocks of [row][column][lane] numbers, compiled once for
// each instruction set that a machine may have and chosen when the program runs. Lanes never meet,
// and every sum runs in one order, so all sets with a fused multiply-add give the same bits; the
// baseline of x86-64, which has none, gives its own.
//
// lanes: 4 or 8. Diagonals of L hold the inverse of the pivot, since a division costs more than
// all else that a small block has to do.
#pragma once

#include <stddef.h>

namespace limber::bake {

// What one supernode takes from another. Rows are row numbers of the whole matrix.
struct ProductsView {
  const double* from;  // [from_num_rows][from_width][lanes]
  ptrdiff_t from_width;
  const int* from_rows;
  ptrdiff_t begin,
      end;  // rows of `from` that are columns of `to`; all from `begin` on are its rows
  ptrdiff_t from_num_rows;
  const int* local;  // of a row number: its place among the rows of `to`
  ptrdiff_t to_first, to_width;
  double* to;  // [..][to_width][lanes]
};

struct PanelView {
  const double* values;  // [num_rows][width][lanes]
  const int* rows;
  ptrdiff_t num_rows, width;
};

struct CholeskyKernels {
  const char* name;

  // May leave anything above the diagonal of `to`.
  void (*subtract_products)(const ProductsView& view, ptrdiff_t lanes);

  // L of a panel in place, its first `width` rows being the diagonal block; zero above the
  // diagonal. Where a lane's pivot is not positive it becomes one, and definite[lane] false.
  void (*factor_panel)(double* panel, ptrdiff_t num_rows, ptrdiff_t width, ptrdiff_t lanes,
                       bool* definite);

  // x: [n][lanes].
  void (*solve_forward)(const PanelView& panel, ptrdiff_t lanes, double* x);
  void (*solve_backward)(const PanelView& panel, ptrdiff_t lanes, double* x);
};

extern const CholeskyKernels kBaselineCholeskyKernels;
#ifdef LIMBER_X86_CHOLESKY_KERNELS
extern const CholeskyKernels kAvx2CholeskyKernels;
extern const CholeskyKernels kAvx512CholeskyKernels;
#endif

// The widest that this machine has.
const CholeskyKernels& ChooseCholeskyKernels();

// All that this machine has, narrowest first, null-terminated: for tests.
const CholeskyKernels* const* AvailableCholeskyKernels();

}  // namespace limber::bake
