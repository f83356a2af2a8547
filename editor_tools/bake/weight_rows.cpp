#include "bake/weight_rows.h"

#include "core/vector.h"
#include "geometry/union_find.h"

#include <algorithm>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;

// Where nothing says whom a vertex follows, it follows as its neighbours do.
void FillEmptyRows(const geometry::SolveMesh& mesh, MatrixXd* weights) {
  Vector<bool> filled(static_cast<size_t>(weights->rows()));
  for (Eigen::Index v = 0; v < weights->rows(); ++v)
    filled[v] = weights->row(v).sum() > 0;
  while (std::find(filled.begin(), filled.end(), false) != filled.end()) {
    MatrixXd sums = MatrixXd::Zero(weights->rows(), weights->cols());
    Vector<bool> reached = filled;
    const auto spread = [&](int from, int to) {
      if (!filled[from] || filled[to]) return;
      sums.row(to) += weights->row(from) / weights->row(from).sum();
      reached[to] = true;
    };
    const auto spread_both = [&](int a, int b) {
      spread(a, b);
      spread(b, a);
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      spread_both(a, b);
      spread_both(b, c);
      spread_both(c, a);
    }
    for (const geometry::Bridge& bridge : mesh.bridges)
      spread_both(bridge.a, bridge.b);
    for (size_t v = 0; v < filled.size(); ++v) {
      const auto row = static_cast<Eigen::Index>(v);
      if (reached[v] && !filled[v]) weights->row(row) = sums.row(row);
    }
    filled = reached;
  }
}

}  // namespace

Status CheckWeightInput(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices) {
  if (handle_vertices.empty()) {
    return Error(StatusCode::kNoHandles, "skinning weights: there is no handle; add one");
  }
  Vector<bool> taken(static_cast<size_t>(mesh.num_vertices()), false);
  for (size_t h = 0; h < handle_vertices.size(); ++h) {
    const int v = handle_vertices[h];
    if (v < 0 || v >= mesh.num_vertices() || taken[v]) {
      return Error(StatusCode::kInvalidArgument,
                   "skinning weights: handle %zu: vertex %d is taken or does not exist; handles "
                   "need distinct vertices below %d",
                   h, v, mesh.num_vertices());
    }
    taken[v] = true;
  }
  if (!mesh.shapes[0].allFinite()) {
    return Error(StatusCode::kDegenerate,
                 "skinning weights: the first shape has a position that is not finite; repair it");
  }
  geometry::UnionFind sets(mesh.num_vertices());
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.Unite(a, b);
    sets.Unite(a, c);
  }
  for (const geometry::Bridge& bridge : mesh.bridges)
    sets.Unite(bridge.a, bridge.b);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (sets.Find(v) != 0) {
      return Error(StatusCode::kDegenerate,
                   "skinning weights: vertex %d is not connected to vertex 0; tie loose parts "
                   "with bridges first",
                   v);
    }
  }
  return {};
}

void CompleteRows(const geometry::SolveMesh& mesh, MatrixXd* weights) {
  FillEmptyRows(mesh, weights);
  for (Eigen::Index v = 0; v < weights->rows(); ++v)
    weights->row(v) /= weights->row(v).sum();
}

Result<MatrixXd> CompletePaintedWeights(const geometry::SolveMesh& mesh, int num_handles,
                                        const MatrixXd& painted) {
  const auto num_draw_vertices = static_cast<Eigen::Index>(mesh.solve_vertex.size());
  if (painted.rows() != num_draw_vertices || painted.cols() != num_handles) {
    return Error(StatusCode::kInvalidArgument,
                 "painted weights: %lld vertices by %lld handles; expected %lld by %d",
                 static_cast<long long>(painted.rows()), static_cast<long long>(painted.cols()),
                 static_cast<long long>(num_draw_vertices), num_handles);
  }
  for (Eigen::Index h = 0; h < painted.cols(); ++h) {
    if (!painted.col(h).allFinite() || painted.col(h).minCoeff() < 0) {
      return Error(StatusCode::kInvalidArgument,
                   "painted weights: handle %lld: one is negative or not a finite number; repair "
                   "the painting",
                   static_cast<long long>(h));
    }
    if (painted.col(h).maxCoeff() == 0) {
      return Error(StatusCode::kDegenerate,
                   "painted weights: handle %lld: no vertex follows it; paint some or remove it",
                   static_cast<long long>(h));
    }
  }
  MatrixXd weights = MatrixXd::Zero(mesh.num_vertices(), num_handles);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(mesh.num_vertices());
  for (Eigen::Index d = 0; d < num_draw_vertices; ++d) {
    const auto v = static_cast<Eigen::Index>(mesh.solve_vertex[static_cast<size_t>(d)]);
    weights.row(v) += painted.row(d);
    counts(v) += 1;
  }
  weights = counts.cwiseMax(1).cwiseInverse().asDiagonal() * weights;
  CompleteRows(mesh, &weights);
  return weights;
}

}  // namespace limber::bake
