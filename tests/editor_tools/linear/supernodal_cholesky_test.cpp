// Factors of every size and instruction set, against Eigen's.
#include "linear/supernodal_cholesky.h"

#include "symmetric_matrices.h"

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include <random>

namespace limber::linear {
namespace {

using Eigen::SparseMatrix;
using Eigen::VectorXd;

struct Problem {
  double scale = 0;
  VectorXd diagonal, right;
};

Problem RandomProblem(Eigen::Index size, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(0.01, 2);
  const auto next = [&] { return number(random); };
  Problem problem;
  problem.scale = next();
  problem.diagonal = VectorXd::NullaryExpr(size, next);
  problem.right = VectorXd::NullaryExpr(size, [&] { return next() - 1; });
  return problem;
}

VectorXd EigensAnswer(const SparseMatrix<double>& Q, const Problem& problem) {
  SparseMatrix<double> matrix = problem.scale * Q;
  for (Eigen::Index i = 0; i < Q.cols(); ++i)
    matrix.coeffRef(i, i) += problem.diagonal(i);
  return Eigen::SimplicialLLT<SparseMatrix<double>>(matrix).solve(problem.right);
}

void ExpectEigensAnswers(const SparseMatrix<double>& Q, const PanelKernels& kernels,
                         SupernodalCholesky::Factor* factor) {
  const SupernodalCholesky cholesky(Q, kernels);
  ASSERT_EQ(cholesky.size(), Q.cols());
  for (const uint32_t seed : {3U, 4U}) {
    const Problem problem = RandomProblem(Q.cols(), seed);
    VectorXd solved = problem.right, solved_again = problem.right;
    cholesky.FactoriseAndSolve(problem.scale, problem.diagonal.data(), factor, solved.data());
    ASSERT_TRUE(factor->definite);
    cholesky.Solve(factor, solved_again.data());
    EXPECT_EQ(solved_again, solved);
    const VectorXd expected = EigensAnswer(Q, problem);
    // The same matrix as one of the pattern.
    SparseMatrix<double> matrix = problem.scale * Q;
    for (Eigen::Index i = 0; i < Q.cols(); ++i)
      matrix.coeffRef(i, i) += problem.diagonal(i);
    ASSERT_EQ(matrix.nonZeros(), Q.nonZeros());
    VectorXd from_values = problem.right;
    cholesky.FactoriseAndSolve(matrix.valuePtr(), factor, from_values.data());
    ASSERT_TRUE(factor->definite);
    EXPECT_LT((from_values - expected).norm(), 1e-9 * expected.norm());
    EXPECT_LT((solved - expected).norm(), 1e-9 * expected.norm())
        << kernels.name << ", size " << Q.cols();
  }
}

// Sizes that leave every kind of remainder of tiles and blocks.
TEST(SupernodalCholesky, SolvesWhatEigenSolves_OnEveryInstructionSet) {
  for (const PanelKernels* const* kernels = AvailablePanelKernels(); *kernels; ++kernels) {
    SupernodalCholesky::Factor factor;  // the same for all sizes
    for (int size = 1; size <= 80; ++size)
      ExpectEigensAnswers(RandomMatrix(size, size < 40 ? size : 4, 7), **kernels, &factor);
    for (const int side : {2, 5, 17, 23, 40})
      ExpectEigensAnswers(GridBiharmonic(side), **kernels, &factor);
    ExpectEigensAnswers(RandomMatrix(300, 3, 8), **kernels, &factor);
    ExpectEigensAnswers(RandomMatrix(200, 200, 9), **kernels, &factor);
    SparseMatrix<double> unconnected(50, 50);
    unconnected.setIdentity();
    ExpectEigensAnswers(unconnected, **kernels, &factor);
  }
}

TEST(SupernodalCholesky, Nothing_IsSolved) {
  const SupernodalCholesky cholesky(SparseMatrix<double>(0, 0));
  SupernodalCholesky::Factor factor;
  cholesky.FactoriseAndSolve(1, nullptr, &factor, nullptr);
  EXPECT_TRUE(factor.definite);
}

VectorXd SolvedBy(const PanelKernels& kernels, const SparseMatrix<double>& Q) {
  const SupernodalCholesky cholesky(Q, kernels);
  Problem problem = RandomProblem(Q.cols(), 11);
  SupernodalCholesky::Factor factor;
  cholesky.FactoriseAndSolve(problem.scale, problem.diagonal.data(), &factor, problem.right.data());
  return problem.right;
}

// The first set is the baseline, which on x86-64 cannot fuse and gives its own bits.
TEST(SupernodalCholesky, AllFusedInstructionSets_GiveTheSameBits) {
  const PanelKernels* const* sets = AvailablePanelKernels();
  for (const SparseMatrix<double>& Q : {GridBiharmonic(31), RandomMatrix(150, 5, 2)}) {
    for (int s = 1; sets[s] != nullptr && sets[s + 1] != nullptr; ++s)
      EXPECT_EQ(SolvedBy(*sets[s], Q), SolvedBy(*sets[s + 1], Q)) << sets[s + 1]->name;
  }
}

TEST(SupernodalCholesky, NotDefinite_SaysSo) {
  for (const PanelKernels* const* kernels = AvailablePanelKernels(); *kernels; ++kernels) {
    const SupernodalCholesky cholesky(GridBiharmonic(6), **kernels);
    SupernodalCholesky::Factor factor;
    for (const int negative : {0, 20, 35}) {
      Problem problem = RandomProblem(36, 5);
      problem.diagonal(negative) = -100;
      cholesky.FactoriseAndSolve(problem.scale, problem.diagonal.data(), &factor,
                                 problem.right.data());
      EXPECT_FALSE(factor.definite) << (*kernels)->name << " " << negative;
    }
    Problem sound = RandomProblem(36, 5);
    cholesky.FactoriseAndSolve(sound.scale, sound.diagonal.data(), &factor, sound.right.data());
    EXPECT_TRUE(factor.definite);
  }
}

// The pattern is that of a good order, and merging columns and filling blocks adds little.
TEST(SupernodalCholesky, Grid_StaysSparse) {
  const SparseMatrix<double> Q = GridBiharmonic(60);
  size_t entries = 0;
  for (const int count : EliminateInGoodOrder(Q).counts)
    entries += static_cast<size_t>(count);
  EXPECT_LT(entries, size_t{3600} * 100);
  EXPECT_LT(SupernodalCholesky(Q).num_values(), 2 * entries);
}

}  // namespace
}  // namespace limber::linear
