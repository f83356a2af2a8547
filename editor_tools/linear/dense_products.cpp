#include "linear/dense_products.h"

#include "core/vector.h"
#include "threads/parallel_for.h"

#include <algorithm>

namespace limber::linear {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// A tile's rows of so many columns stay in the first-level cache while all columns of the result
// meet them.
constexpr Index kDepth = 128;
constexpr Index kRowsAtOnce = 128;    // of a product's result, by one thread
constexpr Index kColumnsAtOnce = 16;  // of a sparse matrix's product
constexpr Index kParts = 8;           // of the rows that a symmetric product sums over

Index NumBlocks(Index rows) {
  return (rows + kBlockRows - 1) / kBlockRows;
}

// A panel of count rows and depth columns whose numbers are at(row, column); zero beyond them.
template <class At>
void Pack(Index count, Index depth, const At& at, Vector<double>* panel) {
  panel->assign(static_cast<size_t>(NumBlocks(count) * kBlockRows * depth), 0.0);
  for (Index block = 0; block < NumBlocks(count); ++block) {
    const Index rows = std::min<Index>(kBlockRows, count - block * kBlockRows);
    double* to = panel->data() + block * depth * kBlockRows;
    for (Index column = 0; column < depth; ++column) {
      for (Index row = 0; row < rows; ++row)
        to[column * kBlockRows + row] = at(block * kBlockRows + row, column);
    }
  }
}

// Rows first.. of a^T b, summed over one part of their rows.
MatrixXd PartOfSum(const MatrixXd& a, const MatrixXd& b, Index begin, Index end,
                   const PanelKernels& kernels) {
  const Index size = a.cols();
  MatrixXd sum = MatrixXd::Zero(NumBlocks(size) * kBlockRows, size);
  Vector<double> left, right;
  for (Index first = begin; first < end; first += kDepth) {
    const Index depth = std::min(kDepth, end - first);
    Pack(
        size, depth, [&](Index row, Index k) { return a(first + k, row); }, &left);
    Pack(
        size, depth, [&](Index row, Index k) { return b(first + k, row); }, &right);
    kernels.add_products({left.data(), NumBlocks(size), right.data(), size, depth, sum.data(),
                          sum.rows(), /*only_lower=*/true});
  }
  return sum;
}

}  // namespace

MatrixXd Product(const MatrixXd& a, const MatrixXd& b, int num_threads,
                 const PanelKernels& kernels) {
  const Index columns = b.cols();
  Vector<Vector<double>> right(static_cast<size_t>((b.rows() + kDepth - 1) / kDepth));
  for (size_t part = 0; part < right.size(); ++part) {
    const Index first = static_cast<Index>(part) * kDepth;
    Pack(
        columns, std::min(kDepth, b.rows() - first),
        [&](Index row, Index k) { return b(first + k, row); }, &right[part]);
  }
  MatrixXd product(a.rows(), columns);
  const Index num_chunks = (a.rows() + kRowsAtOnce - 1) / kRowsAtOnce;
  threads::ParallelFor(static_cast<int>(num_chunks), num_threads, [&](int chunk) {
    const Index top = chunk * kRowsAtOnce, rows = std::min(kRowsAtOnce, a.rows() - top);
    // Kept from round to round: fresh memory costs as much as the products.
    static thread_local MatrixXd sums;
    static thread_local Vector<double> left;
    sums.setZero(NumBlocks(rows) * kBlockRows, columns);
    for (size_t part = 0; part < right.size(); ++part) {
      const Index first = static_cast<Index>(part) * kDepth;
      const Index depth = std::min(kDepth, b.rows() - first);
      Pack(
          rows, depth, [&](Index row, Index k) { return a(top + row, first + k); }, &left);
      kernels.add_products({left.data(), NumBlocks(rows), right[part].data(), columns, depth,
                            sums.data(), sums.rows(), /*only_lower=*/false});
    }
    product.middleRows(top, rows) = sums.topRows(rows);
  });
  return product;
}

MatrixXd Product(const Eigen::SparseMatrix<double>& a, const MatrixXd& b, int num_threads) {
  MatrixXd product(a.rows(), b.cols());
  const Index num_chunks = (b.cols() + kColumnsAtOnce - 1) / kColumnsAtOnce;
  threads::ParallelFor(static_cast<int>(num_chunks), num_threads, [&](int chunk) {
    const Index first = chunk * kColumnsAtOnce, count = std::min(kColumnsAtOnce, b.cols() - first);
    product.middleCols(first, count).noalias() = a * b.middleCols(first, count);
  });
  return product;
}

MatrixXd SymmetricProduct(const MatrixXd& a, const MatrixXd& b, int num_threads,
                          const PanelKernels& kernels) {
  const Index size = a.cols(), step = (a.rows() + kParts - 1) / kParts;
  Vector<MatrixXd> parts(kParts);
  threads::ParallelFor(kParts, num_threads, [&](int part) {
    const Index begin = std::min(part * step, a.rows());
    parts[static_cast<size_t>(part)] =
        PartOfSum(a, b, begin, std::min(begin + step, a.rows()), kernels);
  });
  MatrixXd product = parts[0].topRows(size);
  for (Index part = 1; part < kParts; ++part)
    product += parts[static_cast<size_t>(part)].topRows(size);
  product.triangularView<Eigen::StrictlyUpper>() = product.transpose();
  return product;
}

}  // namespace limber::linear
