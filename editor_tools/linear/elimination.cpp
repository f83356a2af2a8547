#include "linear/elimination.h"

#include "core/vector.h"
#include "linear/nested_dissection.h"
#include "threads/parallel_for.h"

#include <Eigen/OrderingMethods>

#include <array>
#include <utility>

namespace limber::linear {
namespace {

using Eigen::SparseMatrix;

// Fills begin and columns, for the order in new_of_old.
void FindRows(const SparseMatrix<double>& Q, Elimination* elimination) {
  const Vector<int>& new_of_old = elimination->new_of_old;
  Vector<size_t>& begin = elimination->begin;
  begin.assign(new_of_old.size() + 1, 0);
  const auto for_each = [&](const auto& body) {
    for (int column = 0; column < Q.cols(); ++column) {
      const int to = new_of_old[static_cast<size_t>(column)];
      for (SparseMatrix<double>::InnerIterator it(Q, column); it; ++it) {
        const int from = new_of_old[static_cast<size_t>(it.row())];
        if (from < to) body(static_cast<size_t>(to), from);
      }
    }
  };
  for_each([&](size_t row, int) { ++begin[row + 1]; });
  for (size_t row = 0; row + 1 < begin.size(); ++row)
    begin[row + 1] += begin[row];
  elimination->columns.resize(begin.back());
  Vector<size_t> next(begin.begin(), begin.end() - 1);
  for_each([&](size_t row, int column) { elimination->columns[next[row]++] = column; });
}

// Liu's algorithm.
void FindTree(Elimination* elimination) {
  const size_t n = elimination->new_of_old.size();
  Vector<int>& parents = elimination->parents;
  parents.assign(n, -1);
  Vector<int> ancestors(n, -1);
  for (size_t row = 0; row < n; ++row) {
    for (size_t e = elimination->begin[row]; e < elimination->begin[row + 1]; ++e) {
      int at = elimination->columns[e];
      while (at != -1 && at < static_cast<int>(row)) {
        const int next = std::exchange(ancestors[static_cast<size_t>(at)], static_cast<int>(row));
        if (next == -1) parents[static_cast<size_t>(at)] = static_cast<int>(row);
        at = next;
      }
    }
  }
}

// [n]: places in which every column comes after its children, and right after the last of them.
Vector<int> PostOrder(const Vector<int>& parents) {
  const size_t n = parents.size();
  Vector<int> child(n, -1), sibling(n, -1), roots, places(n);
  for (size_t i = n; i-- > 0;) {
    if (parents[i] < 0) {
      roots.push_back(static_cast<int>(i));
    } else {
      sibling[i] = std::exchange(child[static_cast<size_t>(parents[i])], static_cast<int>(i));
    }
  }
  int place = 0;
  Vector<int> path;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
    path.push_back(*root);
    while (!path.empty()) {
      int& next = child[static_cast<size_t>(path.back())];
      if (next >= 0) {
        path.push_back(std::exchange(next, sibling[static_cast<size_t>(next)]));
      } else {
        places[static_cast<size_t>(path.back())] = place++;
        path.pop_back();
      }
    }
  }
  return places;
}

// A row of L is what lies on the paths from the entries of Q's row up to the row itself.
void CountColumns(Elimination* elimination) {
  const size_t n = elimination->new_of_old.size();
  elimination->counts.assign(n, 1);
  Vector<int> seen(n, -1);
  for (size_t row = 0; row < n; ++row) {
    seen[row] = static_cast<int>(row);
    for (size_t e = elimination->begin[row]; e < elimination->begin[row + 1]; ++e) {
      for (auto at = static_cast<size_t>(elimination->columns[e]);
           seen[at] != static_cast<int>(row); at = static_cast<size_t>(elimination->parents[at])) {
        seen[at] = static_cast<int>(row);
        ++elimination->counts[at];
      }
    }
  }
}

Vector<int> MinimumDegree(const SparseMatrix<double>& Q) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(Q, order);
  Vector<int> places(static_cast<size_t>(Q.cols()));
  for (int place = 0; place < Q.cols(); ++place)
    places[static_cast<size_t>(order.indices()(place))] = place;
  return places;
}

}  // namespace

double Elimination::Multiplications() const {
  double sum = 0;
  for (const int count : counts)
    sum += 0.5 * count * count;
  return sum;
}

Elimination Eliminate(const SparseMatrix<double>& Q, const Vector<int>& order) {
  Elimination elimination;
  elimination.new_of_old = order;
  FindRows(Q, &elimination);
  FindTree(&elimination);
  const Vector<int> places = PostOrder(elimination.parents);
  for (int& place : elimination.new_of_old)
    place = places[static_cast<size_t>(place)];
  FindRows(Q, &elimination);
  FindTree(&elimination);
  CountColumns(&elimination);
  return elimination;
}

Elimination EliminateInGoodOrder(const SparseMatrix<double>& Q) {
  std::array<Elimination, 2> tried;
  threads::ParallelFor(2, 0, [&](int which) {
    tried[static_cast<size_t>(which)] =
        Eliminate(Q, which == 0 ? MinimumDegree(Q) : NestedDissection(Q));
  });
  const bool is_second = tried[1].Multiplications() < tried[0].Multiplications();
  return std::move(tried[is_second ? 1 : 0]);
}

}  // namespace limber::linear
