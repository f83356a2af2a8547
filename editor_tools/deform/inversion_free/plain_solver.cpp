#include "deform/inversion_free/plain_solver.h"

#include <Eigen/SparseCholesky>

#include <cmath>

namespace limber::deform {
namespace {

using Cholesky = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;

constexpr double kSufficientDecrease = 1e-4;
constexpr int kMostHalvings = 33;

template <int D>
typename SimplexMesh<D>::Positions Moved(const typename SimplexMesh<D>::Positions& x, double t,
                                         const Eigen::VectorXd& step) {
  typename SimplexMesh<D>::Positions moved = x;
  Eigen::Map<Eigen::VectorXd>(moved.data(), moved.size()) += t * step;
  return moved;
}

// Backtracking. False where rounding leaves no decrease to be seen.
template <int D>
bool Descend(const FullEnergy<D>& energy, double tau, double slope, const Eigen::VectorXd& step,
             typename SimplexMesh<D>::Positions* x) {
  const double before = energy.Value(*x, tau);
  for (int halvings = 0; halvings < kMostHalvings; ++halvings) {
    const double t = std::ldexp(1.0, -halvings);
    auto moved = Moved<D>(*x, t, step);
    const double after = energy.Value(moved, tau);
    if (!(after <= before + kSufficientDecrease * t * slope)) continue;
    *x = std::move(moved);
    return after < before;
  }
  return false;
}

}  // namespace

template <int D>
Status SolvePlainly(const FullEnergy<D>& energy, const PlainSolverOptions& options,
                    typename SimplexMesh<D>::Positions* x, InversionFreeReport* report) {
  double tau = options.first_tau;
  for (report->iterations = 0; report->iterations < options.most_iterations;) {
    const Eigen::VectorXd gradient = energy.GradientAt(*x, tau);
    const Cholesky cholesky(energy.HessianAt(*x, tau));
    if (cholesky.info() != Eigen::Success)
      return Error(StatusCode::kDegenerate, "the Hessian at tau %g has no Cholesky factor", tau);
    const Eigen::VectorXd step = -cholesky.solve(gradient);
    const double slope = gradient.dot(step);  // -decrement^2
    const bool went_down = Descend(energy, tau, slope, step, x);
    ++report->iterations;
    if (-slope >= options.tolerance * options.tolerance && went_down) continue;
    if (tau >= options.last_tau) {
      report->converged = true;
      break;
    }
    tau = std::min(tau * options.factor, options.last_tau);
  }
  return {};
}

template <int D>
Status SolveUnconstrained(const FullEnergy<D>& energy, typename SimplexMesh<D>::Positions* x) {
  *x = energy.problem().mesh.rest;
  const Cholesky cholesky(energy.HessianAt(*x, 0));
  if (cholesky.info() != Eigen::Success) {
    return Error(StatusCode::kDegenerate,
                 "the mesh is not held: give a target to a vertex of each part");
  }
  const Eigen::VectorXd step = -cholesky.solve(energy.GradientAt(*x, 0));
  *x = Moved<D>(*x, 1, step);
  return {};
}

template Status SolvePlainly(const FullEnergy<2>&, const PlainSolverOptions&,
                             TriangleMesh::Positions*, InversionFreeReport*);
template Status SolvePlainly(const FullEnergy<3>&, const PlainSolverOptions&, TetMesh::Positions*,
                             InversionFreeReport*);
template Status SolveUnconstrained(const FullEnergy<2>&, TriangleMesh::Positions*);
template Status SolveUnconstrained(const FullEnergy<3>&, TetMesh::Positions*);

}  // namespace limber::deform
