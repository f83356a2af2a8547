// Large products on every instruction set and number of threads, against Eigen's.
#include "linear/dense_products.h"

#include <gtest/gtest.h>

#include <random>

namespace limber::linear {
namespace {

using Eigen::MatrixXd;

MatrixXd Random(Eigen::Index rows, Eigen::Index columns, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  return MatrixXd::NullaryExpr(rows, columns, [&] { return number(random); });
}

struct Sizes {
  Eigen::Index rows, inner, columns;
};

// Around the sizes of blocks, tiles and parts.
constexpr Sizes kSizes[] = {{1, 1, 1},     {8, 128, 4},    {9, 129, 5}, {127, 3, 31},
                            {300, 257, 7}, {1000, 70, 66}, {5, 0, 3}};

TEST(DenseProducts, Product_IsEigens_OnEveryInstructionSet) {
  for (const PanelKernels* const* kernels = AvailablePanelKernels(); *kernels; ++kernels) {
    for (const auto& [rows, inner, columns] : kSizes) {
      const MatrixXd a = Random(rows, inner, 1), b = Random(inner, columns, 2);
      const MatrixXd product = Product(a, b, 2, **kernels);
      ASSERT_EQ(product.rows(), rows);
      ASSERT_EQ(product.cols(), columns);
      EXPECT_LT((product - a * b).lpNorm<Eigen::Infinity>(), 1e-13 * (1.0 + double(inner)))
          << (*kernels)->name << " " << rows << " " << inner << " " << columns;
    }
  }
}

TEST(DenseProducts, SymmetricProduct_IsEigens_OnEveryInstructionSet) {
  for (const PanelKernels* const* kernels = AvailablePanelKernels(); *kernels; ++kernels) {
    for (const auto& [size, rows, unused] : kSizes) {
      const MatrixXd a = Random(rows, size, 3);
      const MatrixXd b = Random(rows, 1, 4).col(0).asDiagonal() * a;
      const MatrixXd product = SymmetricProduct(a, b, 2, **kernels);
      ASSERT_EQ(product.rows(), size);
      EXPECT_LT((product - a.transpose() * b).lpNorm<Eigen::Infinity>(),
                1e-13 * (1.0 + double(rows)))
          << (*kernels)->name << " " << size << " " << rows;
      EXPECT_EQ(product, product.transpose());
    }
  }
}

TEST(DenseProducts, BitsDoNotDependOnThreads) {
  const MatrixXd a = Random(1234, 77, 5), b = Random(77, 50, 6);
  EXPECT_EQ(Product(a, b, 1), Product(a, b, 3));
  EXPECT_EQ(SymmetricProduct(a, a, 1), SymmetricProduct(a, a, 3));
}

// The first set is the baseline, which on x86-64 cannot fuse and gives its own bits.
TEST(DenseProducts, AllFusedInstructionSets_GiveTheSameBits) {
  const MatrixXd a = Random(345, 130, 7), b = Random(130, 21, 8);
  const PanelKernels* const* sets = AvailablePanelKernels();
  for (int s = 1; sets[s] != nullptr && sets[s + 1] != nullptr; ++s) {
    EXPECT_EQ(Product(a, b, 1, *sets[s]), Product(a, b, 1, *sets[s + 1]));
    EXPECT_EQ(SymmetricProduct(a, a, 1, *sets[s]), SymmetricProduct(a, a, 1, *sets[s + 1]));
  }
}

}  // namespace
}  // namespace limber::linear
