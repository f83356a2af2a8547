#include "bake/coarse_surface.h"

#include "core/vector.h"

#include <cmath>
#include <numeric>
#include <utility>

namespace limber::bake {
namespace {

using Eigen::SparseMatrix;
using Eigen::VectorXd;

constexpr double kSmoothing = 2.0 / 3;  // of one step; below one, so that P has no negative entry

// [n]: aggregates of a vertex with all its neighbours in A where none of them is taken; the others
// join the neighbour that they hang on most.
Vector<int> Aggregate(const SparseMatrix<double>& A, int* count) {
  Vector<int> aggregates(static_cast<size_t>(A.cols()), -1);
  *count = 0;
  for (int vertex = 0; vertex < A.cols(); ++vertex) {
    bool is_free = aggregates[static_cast<size_t>(vertex)] < 0;
    for (SparseMatrix<double>::InnerIterator it(A, vertex); it && is_free; ++it)
      is_free = aggregates[static_cast<size_t>(it.row())] < 0;
    if (!is_free) continue;
    for (SparseMatrix<double>::InnerIterator it(A, vertex); it; ++it)
      aggregates[static_cast<size_t>(it.row())] = *count;
    aggregates[static_cast<size_t>(vertex)] = (*count)++;
  }
  const Vector<int> whole = aggregates;
  for (int vertex = 0; vertex < A.cols(); ++vertex) {
    int& aggregate = aggregates[static_cast<size_t>(vertex)];
    if (aggregate >= 0) continue;
    double strongest = -1;
    for (SparseMatrix<double>::InnerIterator it(A, vertex); it; ++it) {
      if (whole[static_cast<size_t>(it.row())] < 0 || std::abs(it.value()) <= strongest) continue;
      strongest = std::abs(it.value());
      aggregate = whole[static_cast<size_t>(it.row())];
    }
    if (aggregate < 0) aggregate = (*count)++;
  }
  return aggregates;
}

// V x aggregates: one where the vertex belongs.
SparseMatrix<double> Membership(const Vector<int>& aggregates, int count) {
  SparseMatrix<double> P(static_cast<Eigen::Index>(aggregates.size()), count);
  Vector<Eigen::Triplet<double>> entries;
  for (size_t vertex = 0; vertex < aggregates.size(); ++vertex)
    entries.emplace_back(static_cast<int>(vertex), aggregates[vertex], 1);
  P.setFromTriplets(entries.begin(), entries.end());
  return P;
}

SparseMatrix<double> Coarser(const SparseMatrix<double>& A, const SparseMatrix<double>& P) {
  const SparseMatrix<double> product = A * P;
  return SparseMatrix<double>(P.transpose()) * product;
}

}  // namespace

CoarseSurface Coarsen(const geometry::RobustLaplacian& surface, int smallest) {
  const SparseMatrix<double>& L = surface.laplacian;
  CoarseSurface coarse{Vector<int>(static_cast<size_t>(L.cols())), L, L, surface.areas};
  std::iota(coarse.aggregate_of.begin(), coarse.aggregate_of.end(), 0);
  int count = static_cast<int>(L.cols());
  while (true) {
    int fewer = 0;
    const Vector<int> aggregates = Aggregate(coarse.touching, &fewer);
    if (fewer < smallest || fewer == count) break;
    coarse.touching = Coarser(coarse.touching, Membership(aggregates, fewer));
    for (int& aggregate : coarse.aggregate_of)
      aggregate = aggregates[static_cast<size_t>(aggregate)];
    count = fewer;
  }
  if (count == L.cols()) return coarse;
  SparseMatrix<double> P = Membership(coarse.aggregate_of, count);
  const VectorXd steps = kSmoothing * L.diagonal().cwiseInverse();
  const SparseMatrix<double> gradients = L * P;
  const SparseMatrix<double> smoothing = steps.asDiagonal() * gradients;
  P -= smoothing;
  coarse.laplacian = Coarser(L, P);
  coarse.areas = P.transpose() * surface.areas;
  return coarse;
}

}  // namespace limber::bake
