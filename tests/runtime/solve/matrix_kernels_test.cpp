// The kernels of plain vectors and matrices, as solve_kernels_test.cpp those over blocks.
#include "core/vector.h"
#include "runtime/solve/kernel_fixture.h"

#include <Eigen/Cholesky>

namespace limber {
namespace {

using test::kBlocks;
using test::RowMajor;

template <class Dimension>
class MatrixKernelsTest : public test::KernelTest<Dimension> {};

TYPED_TEST_SUITE(MatrixKernelsTest, test::Dimensions);

TYPED_TEST(MatrixKernelsTest, VectorSums_AreTheirFormulas) {
  const size_t rows = 5, size = this->chunks_ * kBlockLanes;
  const auto x = this->numbers_.Some(size), y = this->numbers_.Some(size);
  const auto table = this->numbers_.Some(rows * size), scales = this->numbers_.Some(rows);
  const auto run = [&](const SolveKernels& set) {
    AlignedVector<double> sum = y;
    set.add_scaled(0.3, x.data(), this->chunks_, sum.data());
    set.add_rows(table.data(), size, scales.data(), rows, this->chunks_, sum.data());
    sum.push_back(set.dot(x.data(), y.data(), this->chunks_));
    AlignedVector<double> products(rows);
    set.dot_rows(table.data(), size, rows, x.data(), this->chunks_, products.data());
    sum.insert(sum.end(), products.begin(), products.end());
    return sum;
  };
  this->ForEachSet([&](const SolveKernels& set) {
    const AlignedVector<double> sum = run(set);
    double dot = 0;
    for (size_t i = 0; i < size; ++i) {
      double expected = y[i] + 0.3 * x[i];
      for (size_t r = 0; r < rows; ++r)
        expected += scales[r] * table[r * size + i];
      EXPECT_NEAR(sum[i], expected, 1e-14);
      dot += x[i] * y[i];
    }
    EXPECT_NEAR(sum[size], dot, 1e-13);
    for (size_t r = 0; r < rows; ++r)
      EXPECT_EQ(sum[size + 1 + r], set.dot(table.data() + r * size, x.data(), this->chunks_));
  });
  this->ExpectSameBits(run);
}

// R by columns, each with zeros up to four numbers.
template <int K>
AlignedVector<double> ColumnsOf(const AlignedVector<double>& rotations) {
  AlignedVector<double> columns(kBlocks * K * kQuadLanes);
  for (size_t i = 0; i < kBlocks; ++i) {
    for (size_t c = 0; c < K; ++c) {
      for (size_t a = 0; a < K; ++a)
        columns[(i * K + a) * kQuadLanes + c] = rotations[PlaneIndex<K>(i, c, a)];
    }
  }
  return columns;
}

// Of some blocks, more than are fetched ahead.
TYPED_TEST(MatrixKernelsTest, TurnedEntries_AreTheirFormula) {
  constexpr int K = TypeParam::value;
  Vector<int> blocks;
  for (int i = 0; i < static_cast<int>(kBlocks); ++i) {
    if (i % 4 != 2) blocks.push_back(i);
  }
  const auto matrices = this->numbers_.Some(kBlocks * K * K);
  const auto rotations = this->numbers_.template Rotations<K>(kBlocks);
  const AlignedVector<double> columns = ColumnsOf<K>(rotations);
  const size_t j = 5;
  const auto run = [&](const SolveKernels& set) {
    AlignedVector<double> entries(blocks.size());
    set.turned_entries(matrices.data(), columns.data(), columns.data() + j * K * kQuadLanes,
                       blocks.data(), blocks.size(), entries.data());
    return entries;
  };
  this->ForEachSet([&](const SolveKernels& set) {
    const AlignedVector<double> entries = run(set);
    const Eigen::Matrix<double, K, K> turn = MatrixOfBlock<K>(rotations.data(), j);
    for (size_t n = 0; n < blocks.size(); ++n) {
      const auto i = static_cast<size_t>(blocks[n]);
      const Eigen::Matrix<double, K, K> matrix = RowMajor<K>(matrices.data() + i * K * K);
      const Eigen::Matrix<double, K, K> rotation = MatrixOfBlock<K>(rotations.data(), i);
      EXPECT_NEAR(entries[n], (rotation * matrix * turn.transpose()).trace(), 1e-14);
    }
  });
  this->ExpectSameBits(run);
}

TYPED_TEST(MatrixKernelsTest, ProductsOfSingleMatrices_AreTheirFormula) {
  constexpr int K = TypeParam::value;
  const Vector<int> blocks = {0, 3, 4};
  const size_t stride = kBlocks * K * K;
  const auto matrices = this->numbers_.Some(5 * stride);
  const auto m = this->numbers_.Some(blocks.size() * K * K);
  const auto start = this->numbers_.Some(kBlocks * K * kQuadLanes);
  const auto run = [&](const SolveKernels& set) {
    AlignedVector<double> product(start);
    set.add_single_products(matrices.data(), stride, blocks.data(), m.data(), blocks.size(),
                            kBlocks, product.data());
    return product;
  };
  this->ForEachSet([&](const SolveKernels& set) {
    const AlignedVector<double> product = run(set);
    for (size_t i = 0; i < kBlocks; ++i) {
      Eigen::Matrix<double, K, K> expected = Eigen::Matrix<double, K, K>::Zero();
      for (size_t n = 0; n < blocks.size(); ++n) {
        expected += RowMajor<K>(matrices.data() + size_t(blocks[n]) * stride + i * K * K) *
                    RowMajor<K>(m.data() + n * K * K).transpose();
      }
      for (size_t a = 0; a < K; ++a) {
        for (size_t c = 0; c < K; ++c) {
          const size_t at = (i * K + a) * kQuadLanes + c;
          EXPECT_NEAR(product[at] - start[at], expected(Eigen::Index(a), Eigen::Index(c)), 1e-14);
        }
      }
    }
  });
  this->ExpectSameBits(run);
}

TYPED_TEST(MatrixKernelsTest, TurnedRows_AreTheirFormula) {
  constexpr int K = TypeParam::value;
  const size_t quads = 3, stride = quads * kQuadLanes;
  const auto rows = this->numbers_.Some(K * stride), start = this->numbers_.Some(K * stride);
  const auto m = this->numbers_.Some(K * K);
  const auto run = [&](const SolveKernels& set) {
    AlignedVector<double> out(start);
    set.add_turned_rows(m.data(), rows.data(), quads, out.data());
    return out;
  };
  this->ForEachSet([&](const SolveKernels& set) {
    const AlignedVector<double> out = run(set);
    for (size_t at = 0; at < out.size(); ++at) {
      double expected = start[at];
      for (size_t a = 0; a < K; ++a)
        expected += m[at / stride * K + a] * rows[a * stride + at % stride];
      EXPECT_NEAR(out[at], expected, 1e-14);
    }
  });
  this->ExpectSameBits(run);
}

TYPED_TEST(MatrixKernelsTest, Cholesky_SolvesAndSurvivesSingularSystems) {
  for (const size_t size : {size_t{1}, size_t{7}, size_t{8}, size_t{19}}) {
    const size_t stride = PaddedSize(size);
    const auto entries = this->numbers_.Some(size * size);
    const Eigen::Map<const Eigen::MatrixXd> b(entries.data(), Eigen::Index(size),
                                              Eigen::Index(size));
    const Eigen::MatrixXd a =
        b * b.transpose() + 0.1 * Eigen::MatrixXd::Identity(b.rows(), b.rows());
    const auto right = this->numbers_.Some(size);
    const auto run = [&](const SolveKernels& set) {
      AlignedVector<double> factor(size * stride), x(stride);
      for (size_t j = 0; j < size; ++j)
        std::copy_n(a.col(Eigen::Index(j)).data(), size, factor.data() + j * stride);
      std::copy_n(right.data(), size, x.data());
      set.cholesky_factor(factor.data(), size, stride);
      set.cholesky_solve(factor.data(), size, stride, x.data());
      return x;
    };
    const Eigen::VectorXd expected =
        a.llt().solve(Eigen::Map<const Eigen::VectorXd>(right.data(), Eigen::Index(size)));
    this->ForEachSet([&](const SolveKernels& set) {
      const AlignedVector<double> x = run(set);
      for (size_t i = 0; i < stride; ++i)
        EXPECT_NEAR(x[i], i < size ? expected[Eigen::Index(i)] : 0, 1e-10) << i;
      AlignedVector<double> ones(size * stride, 1.0), y(stride, 0.0);
      y[0] = 1;
      set.cholesky_factor(ones.data(), size, stride);
      set.cholesky_solve(ones.data(), size, stride, y.data());
      for (const double value : y)
        EXPECT_TRUE(std::isfinite(value));
    });
    this->ExpectSameBits(run);
  }
}

}  // namespace
}  // namespace limber
