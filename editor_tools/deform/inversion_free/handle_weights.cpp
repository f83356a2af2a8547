#include "deform/inversion_free/handle_weights.h"

#include "bake/bounded_quadratic.h"
#include "bake/quadratic_problem.h"

#include <Eigen/SparseCholesky>

#include <algorithm>

namespace limber::deform {
namespace {

constexpr int kFree = -1;

// The handle that each vertex belongs to.
Result<Vector<int>> OwnersOf(int num_vertices, const Vector<Vector<int>>& handles) {
  Vector<int> owner(static_cast<size_t>(num_vertices), kFree);
  for (size_t h = 0; h < handles.size(); ++h) {
    if (handles[h].empty())
      return Error(StatusCode::kInvalidArgument, "handle %zu: has no vertex", h);
    for (const int v : handles[h]) {
      const bool is_one = v >= 0 && v < num_vertices;
      if (!is_one || owner[static_cast<size_t>(v)] != kFree) {
        return Error(StatusCode::kInvalidArgument,
                     "handle %zu: vertex %d: expected below %d, and in one handle only", h, v,
                     num_vertices);
      }
      owner[static_cast<size_t>(v)] = static_cast<int>(h);
    }
  }
  return owner;
}

// min 1/2 x^T Q x over the vertices that are free, the others given: Q and the pull c of each
// handle's ones.
struct Split {
  Vector<int> free;
  Eigen::SparseMatrix<double> Q;  // free x free
  Eigen::MatrixXd c;              // free x H
};

Split SplitOff(const Eigen::SparseMatrix<double>& Q, const Vector<int>& owner, size_t num_handles) {
  Split split;
  Vector<int> place(owner.size(), -1);
  for (size_t v = 0; v < owner.size(); ++v) {
    if (owner[v] != kFree) continue;
    place[v] = static_cast<int>(split.free.size());
    split.free.push_back(static_cast<int>(v));
  }
  const auto size = static_cast<Eigen::Index>(split.free.size());
  split.c = Eigen::MatrixXd::Zero(size, static_cast<Eigen::Index>(num_handles));
  Vector<Eigen::Triplet<double>> triplets;
  for (int column = 0; column < Q.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(Q, column); entry; ++entry) {
      const int row = place[static_cast<size_t>(entry.row())];
      const int other = owner[static_cast<size_t>(column)];
      if (row < 0) continue;
      if (other == kFree) {
        triplets.emplace_back(row, place[static_cast<size_t>(column)], entry.value());
      } else {
        split.c(row, other) += entry.value();
      }
    }
  }
  split.Q.resize(size, size);
  split.Q.setFromTriplets(triplets.begin(), triplets.end());
  return split;
}

Status SolveHarmonic(const Split& split, Eigen::MatrixXd* free) {
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> cholesky(split.Q);
  if (cholesky.info() != Eigen::Success)
    return Error(StatusCode::kDegenerate, "weights: a part of the mesh has no handle");
  *free = -cholesky.solve(split.c);
  return {};
}

Status SolveBounded(const Split& split, Eigen::MatrixXd* free) {
  const bake::BoundedQuadratic program(split.Q);
  for (Eigen::Index h = 0; h < split.c.cols(); ++h) {
    Eigen::VectorXd x;
    const bake::BoundedQuadraticReport report = program.Solve(
        split.c.col(h), [] { return true; }, &x);
    if (!report.converged && !(report.stationarity < 1e-3)) {
      return Error(
          StatusCode::kDegenerate,
          "weights of handle %td: no optimum was found (%.1e left); is there a part of the "
          "mesh without a handle?",
          h, report.stationarity);
    }
    free->col(h) = x;
  }
  return {};
}

}  // namespace

template <int D>
void AssembleLaplacian(const SimplexMesh<D>& mesh, const Vector<ElementRest<D>>& rest,
                       Eigen::SparseMatrix<double>* laplacian, Eigen::VectorXd* masses) {
  Vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(rest.size() * (D + 1) * (D + 1));
  masses->setZero(mesh.num_vertices());
  for (size_t i = 0; i < rest.size(); ++i) {
    for (int a = 0; a <= D; ++a) {
      const int va = mesh.elements[i][static_cast<size_t>(a)];
      (*masses)[va] += rest[i].volume / (D + 1);
      for (int b = 0; b <= D; ++b) {
        triplets.emplace_back(
            va, mesh.elements[i][static_cast<size_t>(b)],
            rest[i].volume * rest[i].gradients.col(a).dot(rest[i].gradients.col(b)));
      }
    }
  }
  laplacian->resize(mesh.num_vertices(), mesh.num_vertices());
  laplacian->setFromTriplets(triplets.begin(), triplets.end());
}

template <int D>
Result<Eigen::MatrixXd> HandleWeights(const SimplexMesh<D>& mesh,
                                      const Vector<Vector<int>>& handles, HandleWeightKind kind) {
  auto rest = MeasureRest(mesh);
  if (!rest.ok()) return rest.status();
  auto owner = OwnersOf(mesh.num_vertices(), handles);
  if (!owner.ok()) return owner.status();
  Eigen::SparseMatrix<double> laplacian;
  Eigen::VectorXd masses;
  AssembleLaplacian(mesh, *rest, &laplacian, &masses);
  const bool is_harmonic = kind == HandleWeightKind::kHarmonic;
  const Split split = SplitOff(is_harmonic ? laplacian : bake::BiharmonicForm(laplacian, masses),
                               *owner, handles.size());
  Eigen::MatrixXd free(split.c.rows(), split.c.cols());
  const Status solved = is_harmonic ? SolveHarmonic(split, &free) : SolveBounded(split, &free);
  if (!solved.ok()) return solved;
  Eigen::MatrixXd weights =
      Eigen::MatrixXd::Zero(mesh.num_vertices(), static_cast<Eigen::Index>(handles.size()));
  for (size_t v = 0; v < owner->size(); ++v) {
    if ((*owner)[v] != kFree) weights(static_cast<Eigen::Index>(v), (*owner)[v]) = 1;
  }
  for (size_t f = 0; f < split.free.size(); ++f) {
    const Eigen::RowVectorXd row =
        free.row(static_cast<Eigen::Index>(f)).cwiseMax(0.0).cwiseMin(1.0);
    weights.row(split.free[f]) = row / std::max(row.sum(), 1e-300);
  }
  return weights;
}

template void AssembleLaplacian(const TriangleMesh&, const Vector<ElementRest<2>>&,
                                Eigen::SparseMatrix<double>*, Eigen::VectorXd*);
template void AssembleLaplacian(const TetMesh&, const Vector<ElementRest<3>>&,
                                Eigen::SparseMatrix<double>*, Eigen::VectorXd*);
template Result<Eigen::MatrixXd> HandleWeights(const TriangleMesh&, const Vector<Vector<int>>&,
                                               HandleWeightKind);
template Result<Eigen::MatrixXd> HandleWeights(const TetMesh&, const Vector<Vector<int>>&,
                                               HandleWeightKind);

}  // namespace limber::deform
