#include "bake/small_parts.h"

#include "core/vector.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <functional>

namespace limber::bake {
namespace {

using geometry::PointMatrix;

// Along the principal axes, largest first.
Eigen::Vector3d Extents(const PointMatrix& points) {
  const Eigen::RowVector3d middle = points.colwise().mean();
  const PointMatrix centred = points.rowwise() - middle;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(centred.transpose() * centred);
  const PointMatrix turned = centred * solver.eigenvectors();
  Eigen::Vector3d extents = (turned.colwise().maxCoeff() - turned.colwise().minCoeff()).transpose();
  std::sort(extents.begin(), extents.end(), std::greater<>());
  return extents;
}

bool IsSmall(const PointMatrix& points, double diagonal) {
  const Eigen::Vector3d extents = Extents(points);
  return extents[0] <= kSmallPart * diagonal && extents[1] >= kLeastRoundness * extents[0];
}

Vector<Vector<int>> VerticesOfParts(const geometry::SolveMesh& mesh) {
  Vector<Vector<int>> parts(static_cast<size_t>(mesh.num_components));
  for (int v = 0; v < mesh.num_vertices(); ++v)
    parts[static_cast<size_t>(mesh.component[static_cast<size_t>(v)])].push_back(v);
  return parts;
}

}  // namespace

int HoldSmallParts(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices,
                   Eigen::MatrixXd* weights) {
  const auto num_parts = static_cast<size_t>(mesh.num_components);
  Vector<bool> is_free(num_parts, true);
  if (num_parts > 0) is_free[0] = false;  // the body
  for (const int v : handle_vertices)
    is_free[static_cast<size_t>(mesh.component[static_cast<size_t>(v)])] = false;
  const PointMatrix& rest = mesh.shapes[0];
  const double diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
  const Vector<Vector<int>> parts = VerticesOfParts(mesh);
  int held = 0;
  // The bridges of a part lie together, after those of the parts that it is tied to: a pupil comes
  // after its eye.
  for (auto bridge = mesh.bridges.begin(); bridge != mesh.bridges.end();) {
    const auto part = static_cast<size_t>(mesh.component[static_cast<size_t>(bridge->a)]);
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(weights->cols());
    for (; bridge != mesh.bridges.end() &&
           mesh.component[static_cast<size_t>(bridge->a)] == static_cast<int>(part);
         ++bridge) {
      sum += weights->row(bridge->b);
    }
    if (!is_free[part] || !IsSmall(rest(parts[part], Eigen::all), diagonal)) continue;
    for (const int v : parts[part])
      weights->row(v) = sum / sum.sum();
    ++held;
  }
  return held;
}

}  // namespace limber::bake
