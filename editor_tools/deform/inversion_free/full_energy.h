// E(x, tau) of eq. 6 with its derivatives, summed plainly element by element: what tests hold the
// fast solvers against, and what the plain solver of the benchmarks minimises.
#pragma once

#include "deform/inversion_free/problem.h"

#include <Eigen/SparseCore>

namespace limber::deform {

// The eigenvalues of one element's S_i, increasing, with their vectors as columns.
template <int D>
struct StretchEigen {
  Eigen::Matrix<double, D, 1> values;
  Eigen::Matrix<double, D, D> vectors;
};

template <int D>
class FullEnergy {
 public:
  using Positions = typename SimplexMesh<D>::Positions;
  using Gradient = Eigen::Matrix<double, D, D>;

  // Errors: those of CheckProblem and MeasureRest. Keeps a copy.
  static Result<FullEnergy> Create(InversionFreeProblem<D> problem,
                                   const InversionFreeOptions& options);

  const InversionFreeProblem<D>& problem() const { return problem_; }

  const Vector<ElementRest<D>>& rest() const { return rest_; }

  // tau = 0: without the penalty, whatever its kind.
  double Value(const Positions& x, double tau) const;
  // [V * D], vertex by vertex, as rows of Positions lie in memory.
  Eigen::VectorXd GradientAt(const Positions& x, double tau) const;
  // [V * D][V * D], whole.
  Eigen::SparseMatrix<double> HessianAt(const Positions& x, double tau) const;

  Gradient DeformationGradient(const Positions& x, size_t element) const;  // F_i
  StretchEigen<D> StretchOf(const Positions& x, size_t element) const;
  // The multiplier of the constraint S_i >= epsilon that the penalty stands for: -dE_pen/dS_i.
  Gradient Multiplier(const StretchEigen<D>& stretch, double tau) const;

 private:
  using Dofs = Eigen::Matrix<double, D*(D + 1), 1>;
  using Block = Eigen::Matrix<double, D*(D + 1), D*(D + 1)>;

  FullEnergy() = default;
  Block ElementHessian(const Positions& x, size_t element, double tau) const;

  InversionFreeProblem<D> problem_;
  InversionFreeOptions options_;
  Vector<ElementRest<D>> rest_;
  Vector<double> weights_;
};

}  // namespace limber::deform
