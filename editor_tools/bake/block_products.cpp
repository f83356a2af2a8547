#include "bake/block_products.h"

#include "bake/parallel_for.h"

#include <algorithm>

namespace limber::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index kBlock = 64;  // columns

template <class Body>
void ForBlocks(Index columns, int num_threads, const Body& body) {
  const auto count = static_cast<int>((columns + kBlock - 1) / kBlock);
  ParallelFor(count, num_threads, [&](int block) {
    const Index first = block * kBlock;
    body(first, std::min(kBlock, columns - first));
  });
}

}  // namespace

MatrixXd Product(const MatrixXd& a, const MatrixXd& b, int num_threads) {
  MatrixXd product(a.rows(), b.cols());
  ForBlocks(b.cols(), num_threads, [&](Index first, Index width) {
    product.middleCols(first, width).noalias() = a * b.middleCols(first, width);
  });
  return product;
}

MatrixXd SymmetricProduct(const MatrixXd& a, const MatrixXd& b, int num_threads) {
  const Index size = a.cols();
  MatrixXd product(size, size);
  ForBlocks(size, num_threads, [&](Index first, Index width) {
    product.block(first, first, size - first, width).noalias() =
        a.rightCols(size - first).transpose() * b.middleCols(first, width);
  });
  product.triangularView<Eigen::StrictlyUpper>() = product.transpose();
  return product;
}

}  // namespace limber::bake
