// The convex problem of Liu et al. 2016, "Fast and Robust Inversion-Free Shape Manipulation":
//
//   min_x  E_ex + alpha |C x - d|^2 + incompressibility   subject to   S_i - epsilon I >= 0,
//   E_ex = sum_i w_i |F_i - R_i|^2,   S_i the symmetric part of R_i^T F_i             (eq. 1 to 3)
//
// A positive semi-definite S_i means det F_i >= 0: no element is inside out. The rotations R_i (the
// ex-rotation field) are given, so that everything is convex, with one optimum, which does not
// depend on a start or on what was there before.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "deform/inversion_free/penalty.h"
#include "deform/inversion_free/simplex_mesh.h"

#include <Eigen/Core>

namespace limber::deform {

enum class ElementWeights {
  kVolume,   // w_i: the volume by the mean volume; the result does not depend on how it is meshed
  kUniform,  // 1, as the paper has it
};

struct InversionFreeOptions {
  ElementWeights weights = ElementWeights::kVolume;
  double target_weight = 1e4;      // alpha
  double incompressibility = 0;    // times w_i / 2 trace^2(R_i^T F_i - I) (eq. 9)
  double smallest_stretch = 1e-6;  // epsilon: eigenvalues of S_i stay above
  PenaltyKind penalty = PenaltyKind::kQuadratic;
};

template <int D>
struct InversionFreeProblem {
  using Positions = typename SimplexMesh<D>::Positions;
  using Rotation = Eigen::Matrix<double, D, D>;

  SimplexMesh<D> mesh;
  Vector<Rotation> rotations;   // [elements]: R_i
  Vector<int> target_vertices;  // C, each once
  Positions targets;            // [target_vertices]: d
};

// Errors: those of MeasureRest; kInvalidArgument (sizes, a rotation that is none, a vertex that is
// none or named twice, no target at all, numbers that are not finite or out of range).
template <int D>
Status CheckProblem(const InversionFreeProblem<D>& problem, const InversionFreeOptions& options);

// w: [elements].
template <int D>
Vector<double> WeightsOf(const Vector<ElementRest<D>>& rest, ElementWeights kind);

}  // namespace limber::deform
