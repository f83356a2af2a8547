// The inner loops of LaneCholesky: dense blocks of [row][column][lane] numbers. Compiled for the
// instruction sets that a machine may have; all give the same bits, since lanes never meet and
// nothing is fused.
#pragma once

#include <cstddef>

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

void SubtractProducts(const ProductsView& view, int lanes);

// L of a panel in place, its first `width` rows being the diagonal block. Where a lane's pivot is
// not positive it becomes one, and definite[lane] false.
void FactorPanel(double* panel, ptrdiff_t num_rows, ptrdiff_t width, int lanes, bool* definite);

struct PanelView {
  const double* values;  // [num_rows][width][lanes]
  const int* rows;
  ptrdiff_t num_rows, width;
};

// x: [n][lanes].
void SolveForward(const PanelView& panel, int lanes, double* x);
void SolveBackward(const PanelView& panel, int lanes, double* x);

}  // namespace limber::bake
