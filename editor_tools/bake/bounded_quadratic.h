// Convex quadratic programs with bounds 0..1, to full accuracy: the engine of the skinning weights.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>

namespace limber::bake {

struct BoundedQuadraticReport {
  int iterations = 0;
  // Largest entry of x - clamp(x - gradient / gradient_scale, 0, 1): zero exactly at the optimum.
  double stationarity = 0;
  // Upper bound on the excess of the objective over its minimum, relative to the objective's size
  // ½ x^T Q x + |c^T x|.
  double gap = 0;
  bool converged = false;
};

// min ½ x^T Q x + c^T x subject to 0 <= x <= 1, for symmetric positive definite Q given whole.
// Mehrotra's predictor-corrector interior point method; one sparse factorisation an iteration, the
// pattern being analysed once. Const methods may be called from many threads at once.
class BoundedQuadratic {
 public:
  explicit BoundedQuadratic(const Eigen::SparseMatrix<double>& Q) : Q_(Q) {}

  // Solves for one c. `keep_going` is asked before each iteration; false stops with
  // converged == false. `x` holds the last iterate in any case, inside the bounds.
  void Solve(const Eigen::VectorXd& c, const std::function<bool()>& keep_going, Eigen::VectorXd* x,
             BoundedQuadraticReport* report) const;

 private:
  Eigen::SparseMatrix<double> Q_;
};

}  // namespace limber::bake
