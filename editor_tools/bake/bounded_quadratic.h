// Convex quadratic programs with bounds 0..1, to full accuracy: the engine of the skinning weights.
#pragma once

#include "bake/lane_cholesky.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>
#include <vector>

namespace limber::bake {

struct BoundedQuadraticReport {
  int iterations = 0;
  // Largest entry of x - clamp(x - gradient / gradient_scale, 0, 1): zero exactly at the optimum.
  double stationarity = 0;
  // Upper bound on the excess of the objective over its minimum, relative to the objective's size
  // ½ x^T Q x + |c^T x|, or to a millionth of the largest |c_i| where that is smaller.
  double gap = 0;
  bool converged = false;
};

// min ½ x^T Q x + c^T x subject to 0 <= x <= 1, for symmetric positive definite Q given whole and
// several c at once. Mehrotra's predictor-corrector interior point method; one sparse factorisation
// an iteration for each c, those of all c side by side (lane_cholesky.h). Each solution has the
// same bits whatever it is solved beside. Const methods may be called from many threads at once.
class BoundedQuadratic {
 public:
  static constexpr int kMostAtOnce = LaneCholesky::kMany;

  explicit BoundedQuadratic(const Eigen::SparseMatrix<double>& Q);

  // Solves for the columns of c, at most kMostAtOnce. `keep_going` is asked before each iteration;
  // false stops with converged == false. The columns of `x` hold the last iterates in any case,
  // inside the bounds.
  void Solve(const Eigen::MatrixXd& c, const std::function<bool()>& keep_going, Eigen::MatrixXd* x,
             std::vector<BoundedQuadraticReport>* reports) const;

 private:
  Eigen::SparseMatrix<double> Q_;
  LaneCholesky cholesky_;
};

}  // namespace limber::bake
