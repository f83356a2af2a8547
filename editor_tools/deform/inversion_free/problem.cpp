#include "deform/inversion_free/problem.h"

#include <Eigen/LU>

#include <cmath>

namespace limber::deform {
namespace {

Status CheckNumber(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return Error(StatusCode::kInvalidArgument, "%s: %g; expected %g to %g", name, value, least, most);
}

Status CheckOptions(const InversionFreeOptions& options) {
  for (const Status& status : {CheckNumber("target weight", options.target_weight, 1e-6, 1e12),
                               CheckNumber("incompressibility", options.incompressibility, 0, 1e6),
                               CheckNumber("smallest stretch", options.smallest_stretch, 0, 0.5)}) {
    if (!status.ok()) return status;
  }
  return {};
}

template <int D>
Status CheckRotations(const InversionFreeProblem<D>& problem) {
  using Rotation = typename InversionFreeProblem<D>::Rotation;
  if (problem.rotations.size() != problem.mesh.elements.size()) {
    return Error(StatusCode::kInvalidArgument, "%zu rotations; expected %zu, one an element",
                 problem.rotations.size(), problem.mesh.elements.size());
  }
  for (size_t i = 0; i < problem.rotations.size(); ++i) {
    const Rotation& r = problem.rotations[i];
    const bool is_one = (r.transpose() * r - Rotation::Identity()).cwiseAbs().maxCoeff() < 1e-9 &&
                        r.determinant() > 0;
    if (!is_one) return Error(StatusCode::kInvalidArgument, "rotation of element %zu: is none", i);
  }
  return {};
}

template <int D>
Status CheckTargets(const InversionFreeProblem<D>& problem) {
  const size_t count = problem.target_vertices.size();
  if (count == 0) return Error(StatusCode::kInvalidArgument, "no vertex has a target");
  if (static_cast<size_t>(problem.targets.rows()) != count || !problem.targets.allFinite()) {
    return Error(StatusCode::kInvalidArgument, "targets: %td positions; expected %zu, finite",
                 problem.targets.rows(), count);
  }
  Vector<bool> seen(static_cast<size_t>(problem.mesh.num_vertices()), false);
  for (const int v : problem.target_vertices) {
    if (v < 0 || v >= problem.mesh.num_vertices() || seen[static_cast<size_t>(v)]) {
      return Error(StatusCode::kInvalidArgument,
                   "target vertex %d: expected below %d, each only once", v,
                   problem.mesh.num_vertices());
    }
    seen[static_cast<size_t>(v)] = true;
  }
  return {};
}

}  // namespace

template <int D>
Status CheckProblem(const InversionFreeProblem<D>& problem, const InversionFreeOptions& options) {
  for (const Status& status :
       {CheckOptions(options), CheckRotations(problem), CheckTargets(problem)}) {
    if (!status.ok()) return status;
  }
  return {};
}

template <int D>
Vector<double> WeightsOf(const Vector<ElementRest<D>>& rest, ElementWeights kind) {
  Vector<double> weights(rest.size(), 1.0);
  if (kind == ElementWeights::kUniform) return weights;
  double sum = 0;
  for (const ElementRest<D>& element : rest)
    sum += element.volume;
  for (size_t i = 0; i < rest.size(); ++i)
    weights[i] = rest[i].volume * static_cast<double>(rest.size()) / sum;
  return weights;
}

template Status CheckProblem(const InversionFreeProblem<2>&, const InversionFreeOptions&);
template Status CheckProblem(const InversionFreeProblem<3>&, const InversionFreeOptions&);
template Vector<double> WeightsOf(const Vector<ElementRest<2>>&, ElementWeights);
template Vector<double> WeightsOf(const Vector<ElementRest<3>>&, ElementWeights);

}  // namespace limber::deform
