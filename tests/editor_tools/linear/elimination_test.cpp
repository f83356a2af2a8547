// Orders of elimination, and what they are said to cost.
#include "linear/elimination.h"

#include "core/vector.h"
#include "linear/nested_dissection.h"
#include "symmetric_matrices.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace limber::linear {
namespace {

using Eigen::MatrixXd;
using Eigen::SparseMatrix;

void ExpectPermutation(const Vector<int>& places, int size) {
  Vector<int> sorted = places;
  std::sort(sorted.begin(), sorted.end());
  ASSERT_EQ(sorted.size(), size_t(size));
  for (int i = 0; i < size; ++i)
    ASSERT_EQ(sorted[size_t(i)], i);
}

TEST(NestedDissection, EveryColumnHasAPlace) {
  for (const int side : {1, 5, 20, 70})
    ExpectPermutation(NestedDissection(GridBiharmonic(side)), side * side);
  for (const int size : {0, 1, 300, 2000})
    ExpectPermutation(NestedDissection(RandomMatrix(size, 3, 1)), size);
  SparseMatrix<double> unconnected(700, 700);
  unconnected.setIdentity();
  ExpectPermutation(NestedDissection(unconnected), 700);
  ExpectPermutation(NestedDissection(RandomMatrix(400, 200, 2)), 400);
}

// The last columns separate: without them, no column of the first half touches the rest.
TEST(NestedDissection, LastOfAll_IsANarrowSeparator) {
  constexpr int kSide = 60, kCount = kSide * kSide;
  const SparseMatrix<double> Q = GridBiharmonic(kSide);
  const Vector<int> places = NestedDissection(Q);
  // Parts that the columns before the separator fall into.
  const int cut = kCount - 3 * kSide;
  Vector<int> part(kCount, -1);
  int parts = 0, largest = 0;
  for (int seed = 0; seed < kCount; ++seed) {
    if (places[size_t(seed)] >= cut || part[size_t(seed)] >= 0) continue;
    Vector<int> reached = {seed};
    part[size_t(seed)] = parts;
    for (size_t i = 0; i < reached.size(); ++i) {
      for (SparseMatrix<double>::InnerIterator it(Q, reached[i]); it; ++it) {
        const auto row = size_t(it.row());
        if (places[row] >= cut || part[row] >= 0) continue;
        part[row] = parts;
        reached.push_back(int(row));
      }
    }
    ++parts;
    largest = std::max(largest, int(reached.size()));
  }
  EXPECT_GE(parts, 2);
  EXPECT_LT(largest, 0.7 * kCount);
}

// Which entries of L are not zero, by elimination of the dense pattern.
Vector<int> CountsSlowly(const SparseMatrix<double>& Q, const Vector<int>& places) {
  const auto n = static_cast<int>(Q.cols());
  Vector<Vector<bool>> full(size_t(n), Vector<bool>(size_t(n), false));
  for (int column = 0; column < n; ++column) {
    for (SparseMatrix<double>::InnerIterator it(Q, column); it; ++it)
      full[size_t(places[size_t(it.row())])][size_t(places[size_t(column)])] = true;
  }
  Vector<int> counts;
  for (int k = 0; k < n; ++k) {
    Vector<int> below;
    for (int row = k + 1; row < n; ++row) {
      if (full[size_t(row)][size_t(k)]) below.push_back(row);
    }
    for (const int i : below) {
      for (const int j : below)
        full[size_t(i)][size_t(j)] = true;
    }
    counts.push_back(1 + static_cast<int>(below.size()));
  }
  return counts;
}

TEST(Elimination, CountsAreThoseOfTheDensePattern) {
  for (const SparseMatrix<double>& Q :
       {RandomMatrix(1, 1, 1), RandomMatrix(60, 2, 4), RandomMatrix(90, 1, 5), GridBiharmonic(9)}) {
    Vector<int> given(static_cast<size_t>(Q.cols()));
    std::iota(given.rbegin(), given.rend(), 0);
    for (const Vector<int>& order : {given, NestedDissection(Q)}) {
      const Elimination elimination = Eliminate(Q, order);
      ExpectPermutation(elimination.new_of_old, static_cast<int>(Q.cols()));
      EXPECT_EQ(elimination.counts, CountsSlowly(Q, elimination.new_of_old));
    }
  }
}

TEST(Elimination, ColumnsComeRightAfterTheirSubtree) {
  const Elimination elimination = EliminateInGoodOrder(RandomMatrix(200, 1, 3));
  const auto n = static_cast<int>(elimination.parents.size());
  Vector<int> first(static_cast<size_t>(n)), size(static_cast<size_t>(n), 1);
  std::iota(first.begin(), first.end(), 0);
  for (int column = 0; column < n; ++column) {
    const int parent = elimination.parents[size_t(column)];
    EXPECT_EQ(first[size_t(column)] + size[size_t(column)], column + 1);
    if (parent < 0) continue;
    ASSERT_GT(parent, column);
    first[size_t(parent)] = std::min(first[size_t(parent)], first[size_t(column)]);
    size[size_t(parent)] += size[size_t(column)];
  }
}

TEST(Elimination, TheBetterOrderIsTaken) {
  const SparseMatrix<double> grid = GridBiharmonic(60);
  const double dissected = Eliminate(grid, NestedDissection(grid)).Multiplications();
  EXPECT_LE(EliminateInGoodOrder(grid).Multiplications(), dissected);
  Vector<int> given(static_cast<size_t>(grid.cols()));
  std::iota(given.begin(), given.end(), 0);
  EXPECT_LT(dissected, 0.5 * Eliminate(grid, given).Multiplications());
}

}  // namespace
}  // namespace limber::linear
