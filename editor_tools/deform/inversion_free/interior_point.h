// The same optimum as algorithm 1 reaches, in a quarter of its steps: an infeasible primal-dual
// interior point method for the semidefinite program.
//
//   S_i(x) - epsilon I = Y_i > 0 with multipliers Z_i > 0; along the path Y_i Z_i = mu I, mu -> 0.
//
// Nesterov and Todd's scaling (1997), Mehrotra's predictor and corrector; one factorisation a step.
// The start may be any: Y_i need not fit x before the end. Steps hardly depend on how hard a wish
// is; of algorithm 1 they do, since its penalty grows steep where elements are about to be met.
#pragma once

#include "deform/inversion_free/full_energy.h"
#include "deform/inversion_free/solve_report.h"
#include "linear/supernodal_cholesky.h"

#include <functional>

namespace limber::deform {

struct InteriorPointOptions {
  double gap = 1e-9;          // of the duality gap to the energy
  double violation = 1e-9;    // largest |S_i - epsilon I - Y_i|
  int most_iterations = 100;  // in practice 10 to 30
};

template <int D>
class InteriorPoint {
 public:
  using Positions = typename SimplexMesh<D>::Positions;
  // Told of each iterate; false stops with what there is.
  using Progress = std::function<bool(const Positions& x, int iteration)>;

  // Analyses the pattern once. Keeps a reference.
  explicit InteriorPoint(const FullEnergy<D>& energy, double smallest_stretch);

  // x: in the start, out the solution; report: all but what Measure fills in. Errors: kDegenerate
  // (a system that has no Cholesky factor: the mesh is not held).
  Status Solve(const InteriorPointOptions& options, const Progress& progress, Positions* x,
               InversionFreeReport* report);

 private:
  using Matrix = Eigen::Matrix<double, D, D>;

  static constexpr int kDofs = D * (D + 1);  // coordinates of an element's corners

  // One element's constraint.
  struct Constraint {
    Matrix slack = Matrix::Identity(), multiplier = Matrix::Identity();  // Y, Z
    Matrix violation;                                                    // S - epsilon I - Y
    Matrix unscale;                          // G^-1: both are diag(scaled) in its coordinates
    Eigen::Matrix<double, D, 1> scaled;      // lambda
    Matrix slack_step, multiplier_step;      // dY, dZ
    Matrix scaled_slack, scaled_multiplier;  // the predictor's, in those coordinates
  };

  struct Residuals {
    double gap = 0, violation = 0;
    Eigen::VectorXd stationarity;
  };

  void Begin(const Positions& x);
  Matrix StretchAt(const Positions& x, size_t element) const;  // S_i - epsilon I
  Matrix StretchStep(const Eigen::VectorXd& step, size_t element) const;
  void AddAdjoint(const Matrix& z, size_t element, Eigen::VectorXd* gradient) const;
  Residuals Linearise(const Positions& x);
  void Scale(Constraint* constraint) const;
  void AddHessian(size_t element);
  Matrix Pull(const Constraint& constraint, double goal, bool is_corrector) const;
  Eigen::VectorXd RightSide(const Residuals& residuals, double goal, bool is_corrector) const;
  double StepLength(const Eigen::VectorXd& step, double goal, bool is_corrector);
  double GapAfter(double length) const;

  const FullEnergy<D>& energy_;
  double smallest_stretch_;
  Eigen::SparseMatrix<double> hessian_;  // without constraints
  Eigen::VectorXd gradient_at_zero_;
  Vector<std::array<int, size_t{kDofs} * kDofs>> places_;  // of each element's block in values_
  Eigen::VectorXd values_;
  linear::SupernodalCholesky cholesky_;
  linear::SupernodalCholesky::Factor factor_;
  Vector<Constraint> constraints_;
};

}  // namespace limber::deform
