// The inner loops of SupernodalCholesky and of dense products over panels, compiled once for each
// instruction set that a machine may have and chosen when the program runs. Every sum runs in one
// order, so all sets with a fused multiply-add give the same bits; the baseline of x86-64, which
// has none, gives its own.
//
// A panel holds some columns of L with one pattern, `width` of them: the triangle, then the rows
// below. Rows lie in blocks of kBlockRows, [block][column][row in block], so that a register takes
// rows of one column, and the products of two panels run through both in the order of their
// numbers. Rows beyond the last are zero, and so is what lies above the diagonal. Diagonals hold
// the inverse of the pivot, since a division costs more than all else that a small panel has to do.
#pragma once

#include <stddef.h>

namespace limber::linear {

inline constexpr int kBlockRows = 8;

struct PanelView {
  const double* values;
  const int* rows;  // row numbers in the whole matrix, ascending; the first `width` without a gap
  ptrdiff_t num_rows, width;
};

// What one panel takes from an earlier one.
struct ProductsView {
  PanelView from;
  ptrdiff_t begin,
      end;           // rows of `from` that are columns of `to`; all from `begin` on are its rows
  const int* local;  // of a row number: its place among the rows of `to`
  ptrdiff_t to_first, to_width;
  double* to;
};

// Dense blocks: to[row + column * to_step] += sum over k of a's row times b's row `column`.
struct AddView {
  const double* a;
  ptrdiff_t num_blocks;  // of rows of a
  const double* b;       // as a panel of num_columns rows
  ptrdiff_t num_columns, width;
  double* to;
  ptrdiff_t to_step;
  bool only_lower;  // may leave anything above the diagonal of `to`
};

struct PanelKernels {
  const char* name;

  void (*add_products)(const AddView& view);

  // May leave anything above the diagonal of `to`.
  void (*subtract_products)(const ProductsView& view);

  // L of a panel in place. Where a pivot is not positive it becomes one, and false is returned.
  bool (*factor_panel)(double* panel, ptrdiff_t num_rows, ptrdiff_t width);

  // x: [n], of the whole matrix.
  void (*solve_forward)(const PanelView& panel, double* x);
  void (*solve_backward)(const PanelView& panel, double* x);
};

// Columns that a panel may have.
inline constexpr int kWidestPanel = 128;

extern const PanelKernels kBaselinePanelKernels;
#ifdef LIMBER_X86_PANEL_KERNELS
extern const PanelKernels kAvx2PanelKernels;
extern const PanelKernels kAvx512PanelKernels;
#endif

// The widest that this machine has.
const PanelKernels& ChoosePanelKernels();

// All that this machine has, narrowest first, null-terminated: for tests.
const PanelKernels* const* AvailablePanelKernels();

}  // namespace limber::linear
