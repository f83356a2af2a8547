#include "bake/pivoted_cholesky.h"

#include <gtest/gtest.h>

namespace limber::bake {
namespace {

TEST(PivotedCholesky, FullRank_FactorReproducesTheMatrix) {
  srand(1);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(20, 20);
  const Eigen::MatrixXd matrix = root.transpose() * root;
  const Eigen::MatrixXd factor = PivotedCholesky(matrix, 1e-14);
  EXPECT_EQ(factor.rows(), 20);
  EXPECT_LT((factor.transpose() * factor - matrix).norm(), 1e-12 * matrix.norm());
}

TEST(PivotedCholesky, LowRank_RankIsFoundAndTheFactorStillReproduces) {
  srand(2);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(5, 30);
  const Eigen::MatrixXd matrix = root.transpose() * root;
  const Eigen::MatrixXd factor = PivotedCholesky(matrix, 1e-12);
  EXPECT_EQ(factor.rows(), 5);
  EXPECT_LT((factor.transpose() * factor - matrix).norm(), 1e-11 * matrix.norm());
}

// Each row has exact zeros where earlier rows had their pivots: the packing relies on it.
TEST(PivotedCholesky, Rows_AreZeroAtEarlierPivots) {
  srand(3);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(12, 18);
  const Eigen::MatrixXd factor = PivotedCholesky(root.transpose() * root, 1e-12);
  ASSERT_EQ(factor.rows(), 12);
  for (Eigen::Index row = 0; row < factor.rows(); ++row)
    EXPECT_EQ((factor.row(row).array() == 0).count(), row);
}

TEST(PivotedCholesky, Zero_HasRankZero) {
  EXPECT_EQ(PivotedCholesky(Eigen::MatrixXd::Zero(4, 4), 1e-12).rows(), 0);
}

}  // namespace
}  // namespace limber::bake
