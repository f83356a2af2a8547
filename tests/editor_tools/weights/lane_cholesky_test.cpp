// Many factors of one pattern at once, against Eigen's one after the other.
#include "bake/lane_cholesky.h"

#include "bake/nested_dissection.h"

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace limber::bake {
namespace {

using Eigen::SparseMatrix;
using Eigen::VectorXd;

// Symmetric, diagonally dominant; `per_row` random entries beside the diagonal.
SparseMatrix<double> RandomMatrix(int size, int per_row, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> column(0, size - 1);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < size; ++row) {
    entries.emplace_back(row, row, 3.0 * per_row);
    for (int i = 0; i < per_row; ++i) {
      const int other = column(random);
      const double value = number(random);
      entries.emplace_back(row, other, value);
      entries.emplace_back(other, row, value);
    }
  }
  SparseMatrix<double> Q(size, size);
  Q.setFromTriplets(entries.begin(), entries.end());
  return Q;
}

// The Laplacian's square on a grid, the kind of matrix that weights come from.
SparseMatrix<double> GridBiharmonic(int side) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto edge = [&](int a, int b) {
    entries.emplace_back(a, a, 1);
    entries.emplace_back(b, b, 1);
    entries.emplace_back(a, b, -1);
    entries.emplace_back(b, a, -1);
  };
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const int at = row * side + column;
      if (column + 1 < side) edge(at, at + 1);
      if (row + 1 < side) edge(at, at + side);
    }
  }
  SparseMatrix<double> laplacian(side * side, side * side);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian * laplacian;
}

struct Lanes {
  std::array<double, 8> scales{};
  std::vector<double> diagonal, x;
};

Lanes RandomLanes(int size, int lanes, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(0.01, 2);
  Lanes result;
  for (int lane = 0; lane < lanes; ++lane)
    result.scales[size_t(lane)] = number(random);
  for (int i = 0; i < size * lanes; ++i) {
    result.diagonal.push_back(number(random));
    result.x.push_back(number(random) - 1);
  }
  return result;
}

void ExpectEigensAnswers(const SparseMatrix<double>& Q, int lanes,
                         const CholeskyKernels& kernels = ChooseCholeskyKernels()) {
  const int size = static_cast<int>(Q.cols());
  const LaneCholesky cholesky(Q, kernels);
  ASSERT_EQ(cholesky.size(), size);
  Lanes problem = RandomLanes(size, lanes, 3);
  LaneCholesky::Factor factor;
  std::vector<double> solved = problem.x, solved_again = problem.x;
  cholesky.FactoriseAndSolve(problem.scales.data(), problem.diagonal.data(), lanes, &factor,
                             solved.data());
  cholesky.Solve(&factor, solved_again.data());
  EXPECT_EQ(solved_again, solved);
  for (int lane = 0; lane < lanes; ++lane) {
    ASSERT_TRUE(factor.definite[size_t(lane)]);
    VectorXd right(size), own(size);
    SparseMatrix<double> matrix = problem.scales[size_t(lane)] * Q;
    for (int i = 0; i < size; ++i) {
      right(i) = problem.x[size_t(i * lanes + lane)];
      own(i) = solved[size_t(i * lanes + lane)];
      matrix.coeffRef(i, i) += problem.diagonal[size_t(i * lanes + lane)];
    }
    const VectorXd expected = Eigen::SimplicialLLT<SparseMatrix<double>>(matrix).solve(right);
    EXPECT_LT((own - expected).norm(), 1e-9 * expected.norm()) << "size " << size;
  }
}

TEST(LaneCholesky, SolvesWhatEigenSolves) {
  for (const int lanes : {LaneCholesky::kFew, LaneCholesky::kMany}) {
    for (const int size : {1, 2, 3, 10, 100, 300})
      ExpectEigensAnswers(RandomMatrix(size, 3, uint32_t(size)), lanes);
    for (const int side : {2, 5, 17, 40})
      ExpectEigensAnswers(GridBiharmonic(side), lanes);
  }
}

// Sizes that leave every kind of remainder of tiles and blocks.
TEST(LaneCholesky, EveryInstructionSet_SolvesWhatEigenSolves) {
  for (const CholeskyKernels* const* kernels = AvailableCholeskyKernels(); *kernels; ++kernels) {
    SCOPED_TRACE((*kernels)->name);
    for (const int lanes : {LaneCholesky::kFew, LaneCholesky::kMany}) {
      for (int size = 1; size <= 80; ++size)
        ExpectEigensAnswers(RandomMatrix(size, size < 40 ? size : 4, 7), lanes, **kernels);
      ExpectEigensAnswers(GridBiharmonic(23), lanes, **kernels);
    }
  }
}

std::vector<double> SolvedBy(const CholeskyKernels& kernels, const SparseMatrix<double>& Q,
                             int lanes) {
  const LaneCholesky cholesky(Q, kernels);
  Lanes problem = RandomLanes(static_cast<int>(Q.cols()), lanes, 11);
  LaneCholesky::Factor factor;
  cholesky.FactoriseAndSolve(problem.scales.data(), problem.diagonal.data(), lanes, &factor,
                             problem.x.data());
  return problem.x;
}

// The first set is the baseline, which on x86-64 cannot fuse and gives its own bits.
TEST(LaneCholesky, AllFusedInstructionSets_GiveTheSameBits) {
  const SparseMatrix<double> Q = GridBiharmonic(31);
  const CholeskyKernels* const* sets = AvailableCholeskyKernels();
  for (int s = 1; sets[s] != nullptr && sets[s + 1] != nullptr; ++s) {
    for (const int lanes : {LaneCholesky::kFew, LaneCholesky::kMany})
      EXPECT_EQ(SolvedBy(*sets[s], Q, lanes), SolvedBy(*sets[s + 1], Q, lanes))
          << sets[s + 1]->name;
  }
}

TEST(LaneCholesky, UnconnectedAndDense_AreSolvedToo) {
  SparseMatrix<double> diagonal(50, 50);
  diagonal.setIdentity();
  ExpectEigensAnswers(diagonal, LaneCholesky::kFew);
  ExpectEigensAnswers(RandomMatrix(60, 60, 9), LaneCholesky::kMany);
}

TEST(LaneCholesky, NotDefinite_OnlyThatLaneSaysSo) {
  const SparseMatrix<double> Q = GridBiharmonic(6);
  const LaneCholesky cholesky(Q);
  Lanes problem = RandomLanes(36, 4, 5);
  problem.diagonal[20 * 4 + 2] = -100;
  LaneCholesky::Factor factor;
  cholesky.FactoriseAndSolve(problem.scales.data(), problem.diagonal.data(), 4, &factor,
                             problem.x.data());
  const auto& definite = factor.definite;
  EXPECT_TRUE(definite[0] && definite[1] && definite[3]);
  EXPECT_FALSE(definite[2]);
}

void ExpectPermutation(const std::vector<int>& places, int size) {
  std::vector<int> sorted = places;
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
  const std::vector<int> places = NestedDissection(Q);
  // Parts that the columns before the separator fall into.
  const int cut = kCount - 3 * kSide;
  std::vector<int> part(kCount, -1);
  int parts = 0, largest = 0;
  for (int seed = 0; seed < kCount; ++seed) {
    if (places[size_t(seed)] >= cut || part[size_t(seed)] >= 0) continue;
    std::vector<int> reached = {seed};
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

// The pattern is that of a good order: far from full.
TEST(LaneCholesky, Grid_StaysSparse) {
  const LaneCholesky cholesky(GridBiharmonic(60));
  EXPECT_LT(static_cast<double>(cholesky.num_values()), 3600.0 * 120);
}

}  // namespace
}  // namespace limber::bake
