#include "bake/lane_cholesky.h"

#include "bake/nested_dissection.h"
#include "bake/parallel_for.h"

#include <Eigen/OrderingMethods>

#include <algorithm>
#include <utility>

namespace limber::bake {
namespace {

using Eigen::SparseMatrix;
using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;

// Supernodes are merged where what is stored and multiplied for nothing stays below this share.
constexpr double kWastedShare = 0.15;
constexpr int kWidest = 64;

// [n]: the first row below the diagonal of each column of L, -1 for none (Liu's algorithm).
std::vector<int> EliminationTree(const SparseMatrix<double>& Q) {
  const auto n = static_cast<size_t>(Q.cols());
  std::vector<int> parents(n, -1), ancestors(n, -1);
  for (int column = 0; column < Q.cols(); ++column) {
    for (SparseMatrix<double>::InnerIterator it(Q, column); it; ++it) {
      int at = static_cast<int>(it.row());
      while (at != -1 && at < column) {
        const int next = std::exchange(ancestors[static_cast<size_t>(at)], column);
        if (next == -1) parents[static_cast<size_t>(at)] = column;
        at = next;
      }
    }
  }
  return parents;
}

// [n]: an order in which every column comes after its children, and right after the last of them.
std::vector<int> PostOrder(const std::vector<int>& parents) {
  const size_t n = parents.size();
  std::vector<int> child(n, -1), sibling(n, -1), roots, order;
  for (size_t i = n; i-- > 0;) {
    if (parents[i] < 0) {
      roots.push_back(static_cast<int>(i));
    } else {
      sibling[i] = std::exchange(child[static_cast<size_t>(parents[i])], static_cast<int>(i));
    }
  }
  order.reserve(n);
  std::vector<int> path;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
    path.push_back(*root);
    while (!path.empty()) {
      int& next = child[static_cast<size_t>(path.back())];
      if (next >= 0) {
        path.push_back(std::exchange(next, sibling[static_cast<size_t>(next)]));
      } else {
        order.push_back(path.back());
        path.pop_back();
      }
    }
  }
  return order;
}

SparseMatrix<double> Permuted(const SparseMatrix<double>& Q, const std::vector<int>& new_of_old) {
  Permutation permutation(Q.cols());
  std::copy(new_of_old.begin(), new_of_old.end(), permutation.indices().data());
  SparseMatrix<double> permuted;
  permuted = Q.twistedBy(permutation);
  return permuted;
}

// Sorted rows of every column of L, the diagonal among them.
std::vector<std::vector<int>> Patterns(const SparseMatrix<double>& Q,
                                       const std::vector<int>& parents) {
  const auto n = static_cast<size_t>(Q.cols());
  std::vector<std::vector<int>> patterns(n);
  for (size_t column = 0; column < n; ++column) {
    std::vector<int>& pattern = patterns[column];  // so far what the children left there
    pattern.push_back(static_cast<int>(column));
    for (SparseMatrix<double>::InnerIterator it(Q, static_cast<int>(column)); it; ++it) {
      if (it.row() > it.col()) pattern.push_back(static_cast<int>(it.row()));
    }
    std::sort(pattern.begin(), pattern.end());
    pattern.erase(std::unique(pattern.begin(), pattern.end()), pattern.end());
    pattern.shrink_to_fit();
    if (parents[column] < 0) continue;
    std::vector<int>& up = patterns[static_cast<size_t>(parents[column])];
    up.insert(up.end(), pattern.begin() + 1, pattern.end());
  }
  return patterns;
}

std::vector<int> MinimumDegree(const SparseMatrix<double>& Q) {
  Permutation order;
  Eigen::AMDOrdering<int>()(Q, order);
  const Permutation inverse = order.inverse();
  return {inverse.indices().data(), inverse.indices().data() + Q.cols()};
}

// An order of elimination with its tree and the patterns of L, and the multiplications that a
// factorisation takes.
struct Analysis {
  std::vector<int> new_of_old;
  SparseMatrix<double> permuted;
  std::vector<int> parents;
  std::vector<std::vector<int>> patterns;
  double work = 0;
};

Analysis Analyse(const SparseMatrix<double>& Q, std::vector<int> new_of_old) {
  Analysis analysis;
  const std::vector<int> order = PostOrder(EliminationTree(Permuted(Q, new_of_old)));
  std::vector<int> place(order.size());
  for (size_t i = 0; i < order.size(); ++i)
    place[static_cast<size_t>(order[i])] = static_cast<int>(i);
  for (int& number : new_of_old)
    number = place[static_cast<size_t>(number)];
  analysis.permuted = Permuted(Q, new_of_old);
  analysis.new_of_old = std::move(new_of_old);
  analysis.parents = EliminationTree(analysis.permuted);
  analysis.patterns = Patterns(analysis.permuted, analysis.parents);
  for (const std::vector<int>& pattern : analysis.patterns) {
    const auto size = static_cast<double>(pattern.size());
    analysis.work += 0.5 * size * size;
  }
  return analysis;
}

}  // namespace

// Minimum degree is the better order of small and ragged meshes, nested dissection of large and
// regular ones; both are tried.
LaneCholesky::LaneCholesky(const SparseMatrix<double>& Q, const CholeskyKernels& kernels)
    : kernels_(kernels) {
  std::array<Analysis, 2> orders;
  ParallelFor(2, 0, [&](int which) {
    orders[static_cast<size_t>(which)] =
        Analyse(Q, which == 0 ? MinimumDegree(Q) : NestedDissection(Q));
  });
  Analysis& analysis = orders[1].work < orders[0].work ? orders[1] : orders[0];
  new_of_old_ = std::move(analysis.new_of_old);
  const SparseMatrix<double>& permuted = analysis.permuted;
  entries_begin_.assign(1, 0);
  for (int column = 0; column < permuted.cols(); ++column) {
    for (SparseMatrix<double>::InnerIterator it(permuted, column); it; ++it) {
      if (it.row() >= column) entries_.push_back({static_cast<int>(it.row()), it.value()});
    }
    entries_begin_.push_back(entries_.size());
  }
  FindSupernodes(analysis.parents, std::move(analysis.patterns));
}

// Columns that follow each other up the tree are one supernode where they have one pattern, or
// nearly: the rows are then those of the last one, which holds the others'.
void LaneCholesky::FindSupernodes(const std::vector<int>& parents,
                                  std::vector<std::vector<int>> patterns) {
  const int n = size();
  supernode_of_.resize(static_cast<size_t>(n));
  for (int first = 0; first < n;) {
    int end = first + 1;
    double used = static_cast<double>(patterns[static_cast<size_t>(first)].size());
    for (; end < n && end - first < kWidest && parents[static_cast<size_t>(end) - 1] == end;
         ++end) {
      const double rows = static_cast<double>(patterns[static_cast<size_t>(end)].size());
      const double width = end - first + 1;
      const double held = width * (rows + width - 1) - 0.5 * width * (width - 1);
      if (held * (1 - kWastedShare) > used + rows) break;
      used += rows;
    }
    Supernode supernode;
    supernode.first = first;
    supernode.width = end - first;
    supernode.rows = rows_.size();
    for (int column = first; column < end; ++column) {
      supernode_of_[static_cast<size_t>(column)] = static_cast<int>(supernodes_.size());
      if (column + 1 < end) rows_.push_back(column);
      if (column + 1 < end) std::vector<int>().swap(patterns[static_cast<size_t>(column)]);
    }
    const std::vector<int>& last = patterns[static_cast<size_t>(end) - 1];
    rows_.insert(rows_.end(), last.begin(), last.end());
    supernode.num_rows = static_cast<int>(rows_.size() - supernode.rows);
    supernode.values = num_values_;
    num_values_ += static_cast<size_t>(supernode.num_rows) * static_cast<size_t>(supernode.width);
    supernodes_.push_back(supernode);
    first = end;
  }
}

double* LaneCholesky::Row(const Supernode& supernode, int row, Factor* factor) const {
  return factor->values.data() +
         (supernode.values + static_cast<size_t>(row) * static_cast<size_t>(supernode.width)) *
             static_cast<size_t>(factor->lanes);
}

PanelView LaneCholesky::Panel(const Supernode& supernode, const Factor& factor) const {
  return {factor.values.data() + supernode.values * static_cast<size_t>(factor.lanes),
          rows_.data() + supernode.rows, supernode.num_rows, supernode.width};
}

// from: [n][lanes] in the order of Q; to: in that of the elimination, resized.
void LaneCholesky::Permute(const double* from, int lanes, std::vector<double>* to) const {
  const auto step = static_cast<size_t>(lanes);
  to->resize(new_of_old_.size() * step);
  for (size_t old = 0; old < new_of_old_.size(); ++old) {
    std::copy_n(from + old * step, step, to->data() + static_cast<size_t>(new_of_old_[old]) * step);
  }
}

// The matrix itself, where the supernode's part of L will be. local: of a row, its place there.
void LaneCholesky::Begin(const Supernode& to, const std::vector<int>& local, const double* scales,
                         Factor* factor) const {
  const auto step = static_cast<size_t>(factor->lanes);
  std::fill(Row(to, 0, factor), Row(to, to.num_rows, factor), 0.0);
  for (int column = 0; column < to.width; ++column) {
    const auto offset = static_cast<size_t>(column),
               global = static_cast<size_t>(to.first) + offset;
    for (size_t e = entries_begin_[global]; e < entries_begin_[global + 1]; ++e) {
      const int row = local[static_cast<size_t>(entries_[e].row)];
      double* number = Row(to, row, factor) + offset * step;
      for (size_t lane = 0; lane < step; ++lane)
        number[lane] += scales[lane] * entries_[e].value;
    }
    double* pivot = Row(to, column, factor) + offset * step;
    for (size_t lane = 0; lane < step; ++lane)
      pivot[lane] += factor->diagonal[global * step + lane];
  }
}

// Supernodes with rows that are still to be taken from, each listed where the next of these rows
// belongs.
struct LaneCholesky::Pending {
  explicit Pending(size_t count) : head(count, -1), next(count, -1), rows_done(count, 0) {}

  std::vector<int> head, next, rows_done;  // [supernodes]
};

void LaneCholesky::List(size_t which, int rows_done, Pending* pending) const {
  const Supernode& supernode = supernodes_[which];
  pending->rows_done[which] = rows_done;
  if (rows_done == supernode.num_rows) return;
  const int row = rows_[supernode.rows + static_cast<size_t>(rows_done)];
  const auto later = static_cast<size_t>(supernode_of_[static_cast<size_t>(row)]);
  pending->next[which] = std::exchange(pending->head[later], static_cast<int>(which));
}

// What all supernodes before it take from one, which then are listed again further on.
void LaneCholesky::TakeProducts(size_t target, const std::vector<int>& local, Pending* pending,
                                Factor* factor) const {
  const Supernode& to = supernodes_[target];
  for (int source = pending->head[target]; source >= 0;) {
    const auto which = static_cast<size_t>(source);
    const Supernode& from = supernodes_[which];
    const int* from_rows = rows_.data() + from.rows;
    const int begin = pending->rows_done[which];
    int end = begin;
    while (end < from.num_rows && from_rows[end] < to.first + to.width)
      ++end;
    kernels_.subtract_products(
        {Row(from, 0, factor), from.width, from_rows, begin, end, from.num_rows, local.data(),
         to.first, to.width, Row(to, 0, factor)},
        factor->lanes);
    source = pending->next[which];
    List(which, end, pending);
  }
}

void LaneCholesky::FactoriseAndSolve(const double* scales, const double* diagonal, int lanes,
                                     Factor* factor, double* x) const {
  factor->lanes = lanes;
  factor->definite.fill(true);
  factor->values.Reserve(num_values_ * static_cast<size_t>(lanes));
  Permute(diagonal, lanes, &factor->diagonal);
  Permute(x, lanes, &factor->x);
  Pending pending(supernodes_.size());
  std::vector<int> local(new_of_old_.size(), -1);
  for (size_t target = 0; target < supernodes_.size(); ++target) {
    const Supernode& to = supernodes_[target];
    for (int row = 0; row < to.num_rows; ++row)
      local[static_cast<size_t>(rows_[to.rows + static_cast<size_t>(row)])] = row;
    Begin(to, local, scales, factor);
    TakeProducts(target, local, &pending, factor);
    kernels_.factor_panel(Row(to, 0, factor), to.num_rows, to.width, lanes,
                          factor->definite.data());
    kernels_.solve_forward(Panel(to, *factor), lanes,
                           factor->x.data());  // while it is in the cache
    List(target, to.width, &pending);
  }
  SolveBackward(factor, x);
}

void LaneCholesky::Solve(Factor* factor, double* x) const {
  Permute(x, factor->lanes, &factor->x);
  for (const Supernode& supernode : supernodes_)
    kernels_.solve_forward(Panel(supernode, *factor), factor->lanes, factor->x.data());
  SolveBackward(factor, x);
}

void LaneCholesky::SolveBackward(Factor* factor, double* x) const {
  const auto step = static_cast<size_t>(factor->lanes);
  for (auto supernode = supernodes_.rbegin(); supernode != supernodes_.rend(); ++supernode)
    kernels_.solve_backward(Panel(*supernode, *factor), factor->lanes, factor->x.data());
  for (size_t old = 0; old < new_of_old_.size(); ++old) {
    std::copy_n(factor->x.data() + static_cast<size_t>(new_of_old_[old]) * step, step,
                x + old * step);
  }
}

}  // namespace limber::bake
