// Algorithm 1 of Liu et al. 2016 as it is printed: Newton's method for one tau after another, the
// Hessian assembled and factored anew in every step with Eigen's simplicial Cholesky.
#pragma once

#include "deform/inversion_free/full_energy.h"
#include "deform/inversion_free/solve_report.h"

namespace limber::deform {

struct PlainSolverOptions {
  double first_tau = 1, factor = 10, last_tau = 1e15;  // tau_0, mu, zeta
  double tolerance = 1e-7;  // of the Newton decrement; rounding may end it before
  int most_iterations = 2000;
};

// x: in the start, out the solution. Errors: kDegenerate (a Hessian that has no Cholesky factor).
template <int D>
Status SolvePlainly(const FullEnergy<D>& energy, const PlainSolverOptions& options,
                    typename SimplexMesh<D>::Positions* x, InversionFreeReport* report);

// Ex-rotated elasticity alone: the optimum without the constraints, which needs no start.
template <int D>
Status SolveUnconstrained(const FullEnergy<D>& energy, typename SimplexMesh<D>::Positions* x);

}  // namespace limber::deform
