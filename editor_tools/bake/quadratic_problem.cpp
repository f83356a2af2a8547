#include "bake/quadratic_problem.h"

#include "core/vector.h"

namespace limber::bake {

using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::VectorXd;

SparseMatrix<double> BiharmonicForm(const SparseMatrix<double>& laplacian, const VectorXd& areas) {
  const VectorXd inverse = (areas / areas.mean()).cwiseInverse();
  const SparseMatrix<double> scaled = inverse.asDiagonal() * laplacian;
  SparseMatrix<double> Q = laplacian * scaled;
  const SparseMatrix<double> transposed = Q.transpose();
  return 0.5 * (Q + transposed);
}

QuadraticProblem SplitOffHandles(const SparseMatrix<double>& Q,
                                 std::span<const int> handle_vertices) {
  constexpr int kHandle = -1;
  Vector<int> row_of(static_cast<size_t>(Q.cols()), 0);
  for (const int vertex : handle_vertices)
    row_of[static_cast<size_t>(vertex)] = kHandle;
  QuadraticProblem problem;
  for (size_t vertex = 0; vertex < row_of.size(); ++vertex) {
    if (row_of[vertex] == kHandle) continue;
    row_of[vertex] = static_cast<int>(problem.free_vertices.size());
    problem.free_vertices.push_back(static_cast<int>(vertex));
  }
  const auto num_free = static_cast<Eigen::Index>(problem.free_vertices.size());
  problem.Q.resize(num_free, num_free);
  Vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<size_t>(Q.nonZeros()));
  for (const int column : problem.free_vertices) {
    for (SparseMatrix<double>::InnerIterator it(Q, column); it; ++it) {
      const int row = row_of[static_cast<size_t>(it.row())];
      if (row != kHandle)
        entries.emplace_back(row, row_of[static_cast<size_t>(column)], it.value());
    }
  }
  problem.Q.setFromTriplets(entries.begin(), entries.end());
  problem.c = MatrixXd::Zero(num_free, static_cast<Eigen::Index>(handle_vertices.size()));
  for (size_t h = 0; h < handle_vertices.size(); ++h) {
    for (SparseMatrix<double>::InnerIterator it(Q, handle_vertices[h]); it; ++it) {
      const int row = row_of[static_cast<size_t>(it.row())];
      if (row != kHandle) problem.c(row, static_cast<Eigen::Index>(h)) = it.value();
    }
  }
  return problem;
}

}  // namespace limber::bake
