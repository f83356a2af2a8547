#include "linear/supernodal_cholesky.h"

#include "core/vector.h"

#include <algorithm>
#include <utility>

namespace limber::linear {
namespace {

using Eigen::SparseMatrix;

// Supernodes are merged where what is stored and multiplied for nothing stays below this share.
constexpr double kWastedShare = 0.12;
constexpr int kWidest = 128;
static_assert(kWidest <= kWidestPanel);

size_t NumBlocks(int num_rows) {
  return static_cast<size_t>((num_rows + kBlockRows - 1) / kBlockRows);
}

}  // namespace

SupernodalCholesky::SupernodalCholesky(const SparseMatrix<double>& Q, const PanelKernels& kernels)
    : SupernodalCholesky(Q, EliminateInGoodOrder(Q), kernels) {}

SupernodalCholesky::SupernodalCholesky(const SparseMatrix<double>& Q, Elimination elimination,
                                       const PanelKernels& kernels)
    : kernels_(kernels),
      new_of_old_(std::move(elimination.new_of_old)) {
  old_of_new_.resize(new_of_old_.size());
  for (size_t old = 0; old < new_of_old_.size(); ++old)
    old_of_new_[static_cast<size_t>(new_of_old_[old])] = static_cast<int>(old);
  FindSupernodes(elimination);
  FindRows(elimination);
  PlaceEntries(Q);
}

// Columns that follow each other up the tree are one supernode where they have one pattern, or
// nearly: the rows are then those of the last one, which holds the others'.
void SupernodalCholesky::FindSupernodes(const Elimination& elimination) {
  const int n = size();
  supernode_of_.resize(static_cast<size_t>(n));
  for (int first = 0; first < n;) {
    int end = first + 1;
    double used = elimination.counts[static_cast<size_t>(first)];
    for (; end < n && end - first < kWidest &&
           elimination.parents[static_cast<size_t>(end) - 1] == end;
         ++end) {
      const double rows = elimination.counts[static_cast<size_t>(end)];
      const double width = end - first + 1;
      const double held = width * (rows + width - 1) - 0.5 * width * (width - 1);
      if (held * (1 - kWastedShare) > used + rows) break;
      used += rows;
    }
    Supernode supernode;
    supernode.first = first;
    supernode.width = end - first;
    supernode.num_rows = end - first - 1 + elimination.counts[static_cast<size_t>(end) - 1];
    supernode.rows = rows_.size();
    supernode.values = num_values_;
    num_values_ += NumBlocks(supernode.num_rows) * kBlockRows * static_cast<size_t>(end - first);
    rows_.resize(rows_.size() + static_cast<size_t>(supernode.num_rows));
    std::fill_n(supernode_of_.begin() + first, end - first, static_cast<int>(supernodes_.size()));
    supernodes_.push_back(supernode);
    first = end;
  }
  for (Supernode& supernode : supernodes_) {
    const int up = elimination.parents[static_cast<size_t>(supernode.first + supernode.width) - 1];
    supernode.parent = up < 0 ? -1 : supernode_of_[static_cast<size_t>(up)];
  }
}

// As columns are counted, supernode by supernode; rows come in ascending order.
void SupernodalCholesky::FindRows(const Elimination& elimination) {
  Vector<size_t> next;
  for (const Supernode& supernode : supernodes_) {
    for (int column = 0; column < supernode.width; ++column)
      rows_[supernode.rows + static_cast<size_t>(column)] = supernode.first + column;
    next.push_back(supernode.rows + static_cast<size_t>(supernode.width));
  }
  Vector<int> seen(supernodes_.size(), -1);
  for (int row = 0; row < size(); ++row) {
    seen[static_cast<size_t>(supernode_of_[static_cast<size_t>(row)])] = row;
    for (size_t e = elimination.begin[static_cast<size_t>(row)];
         e < elimination.begin[static_cast<size_t>(row) + 1]; ++e) {
      int at = supernode_of_[static_cast<size_t>(elimination.columns[e])];
      for (; seen[static_cast<size_t>(at)] != row;
           at = supernodes_[static_cast<size_t>(at)].parent) {
        seen[static_cast<size_t>(at)] = row;
        rows_[next[static_cast<size_t>(at)]++] = row;
      }
    }
  }
}

size_t SupernodalCholesky::Place(const Supernode& supernode, int place_in_rows, int column) const {
  const auto row = static_cast<size_t>(place_in_rows), width = static_cast<size_t>(supernode.width);
  const auto offset = static_cast<size_t>(column);
  const size_t before = row / kBlockRows * width + offset;
  return supernode.values + before * kBlockRows + row % kBlockRows;
}

void SupernodalCholesky::PlaceEntries(const SparseMatrix<double>& Q) {
  Vector<int> local(new_of_old_.size(), -1);
  diagonal_places_.resize(new_of_old_.size());
  for (const Supernode& supernode : supernodes_) {
    entries_begin_.push_back(entries_.size());
    for (int row = 0; row < supernode.num_rows; ++row)
      local[static_cast<size_t>(rows_[supernode.rows + static_cast<size_t>(row)])] = row;
    for (int column = 0; column < supernode.width; ++column) {
      const int number = supernode.first + column;
      const auto global = static_cast<size_t>(number);
      diagonal_places_[global] = Place(supernode, column, column);
      for (SparseMatrix<double>::InnerIterator it(Q, old_of_new_[global]); it; ++it) {
        const auto row = static_cast<size_t>(new_of_old_[static_cast<size_t>(it.row())]);
        if (row < global) continue;
        entries_.push_back({Place(supernode, local[row], column), it.value(),
                            static_cast<size_t>(&it.value() - Q.valuePtr())});
      }
    }
  }
  entries_begin_.push_back(entries_.size());
}

PanelView SupernodalCholesky::Panel(const Supernode& supernode, const Factor& factor) const {
  return {factor.values.data() + supernode.values, rows_.data() + supernode.rows,
          supernode.num_rows, supernode.width};
}

// The matrix itself, where the supernode's part of L will be.
void SupernodalCholesky::Begin(size_t which, const Matrix& matrix, Factor* factor) const {
  const Supernode& to = supernodes_[which];
  double* values = factor->values.data();
  std::fill_n(values + to.values,
              NumBlocks(to.num_rows) * kBlockRows * static_cast<size_t>(to.width), 0.0);
  if (matrix.values != nullptr) {
    for (size_t e = entries_begin_[which]; e < entries_begin_[which + 1]; ++e)
      values[entries_[e].place] += matrix.values[entries_[e].source];
    return;
  }
  for (size_t e = entries_begin_[which]; e < entries_begin_[which + 1]; ++e)
    values[entries_[e].place] += matrix.scale * entries_[e].value;
  for (int column = to.first; column < to.first + to.width; ++column) {
    const auto global = static_cast<size_t>(column);
    values[diagonal_places_[global]] += matrix.diagonal[old_of_new_[global]];
  }
}

void SupernodalCholesky::List(size_t which, int rows_done, Factor* factor) const {
  const Supernode& supernode = supernodes_[which];
  factor->rows_done[which] = rows_done;
  if (rows_done == supernode.num_rows) return;
  const int row = rows_[supernode.rows + static_cast<size_t>(rows_done)];
  const auto later = static_cast<size_t>(supernode_of_[static_cast<size_t>(row)]);
  factor->next[which] = std::exchange(factor->head[later], static_cast<int>(which));
}

// What all supernodes before it take from one, which then are listed again further on.
void SupernodalCholesky::TakeProducts(size_t target, Factor* factor) const {
  const Supernode& to = supernodes_[target];
  for (int source = factor->head[target]; source >= 0;) {
    const auto which = static_cast<size_t>(source);
    const Supernode& from = supernodes_[which];
    const int* from_rows = rows_.data() + from.rows;
    const int begin = factor->rows_done[which];
    int end = begin;
    while (end < from.num_rows && from_rows[end] < to.first + to.width)
      ++end;
    kernels_.subtract_products({Panel(from, *factor), begin, end, factor->local.data(), to.first,
                                to.width, factor->values.data() + to.values});
    source = factor->next[which];
    List(which, end, factor);
  }
}

void SupernodalCholesky::FactoriseAndSolve(double scale, const double* diagonal, Factor* factor,
                                           double* x) const {
  Factorise({scale, diagonal, nullptr}, factor, x);
}

void SupernodalCholesky::FactoriseAndSolve(const double* values, Factor* factor, double* x) const {
  Factorise({1, nullptr, values}, factor, x);
}

void SupernodalCholesky::Factorise(const Matrix& matrix, Factor* factor, double* x) const {
  factor->definite = true;
  factor->values.Reserve(num_values_);
  factor->head.assign(supernodes_.size(), -1);
  factor->next.resize(supernodes_.size());
  factor->rows_done.resize(supernodes_.size());
  factor->local.resize(new_of_old_.size());
  Permute(x, factor);
  for (size_t target = 0; target < supernodes_.size(); ++target) {
    const Supernode& to = supernodes_[target];
    for (int row = 0; row < to.num_rows; ++row)
      factor->local[static_cast<size_t>(rows_[to.rows + static_cast<size_t>(row)])] = row;
    Begin(target, matrix, factor);
    TakeProducts(target, factor);
    double* panel = factor->values.data() + to.values;
    factor->definite = kernels_.factor_panel(panel, to.num_rows, to.width) && factor->definite;
    kernels_.solve_forward(Panel(to, *factor), factor->x.data());  // while it is in the cache
    List(target, to.width, factor);
  }
  SolveBackward(factor, x);
}

void SupernodalCholesky::Solve(Factor* factor, double* x) const {
  Permute(x, factor);
  for (const Supernode& supernode : supernodes_)
    kernels_.solve_forward(Panel(supernode, *factor), factor->x.data());
  SolveBackward(factor, x);
}

void SupernodalCholesky::Permute(const double* x, Factor* factor) const {
  factor->x.resize(new_of_old_.size());
  for (size_t place = 0; place < old_of_new_.size(); ++place)
    factor->x[place] = x[old_of_new_[place]];
}

void SupernodalCholesky::SolveBackward(Factor* factor, double* x) const {
  for (auto supernode = supernodes_.rbegin(); supernode != supernodes_.rend(); ++supernode)
    kernels_.solve_backward(Panel(*supernode, *factor), factor->x.data());
  for (size_t place = 0; place < old_of_new_.size(); ++place)
    x[old_of_new_[place]] = factor->x[place];
}

}  // namespace limber::linear
