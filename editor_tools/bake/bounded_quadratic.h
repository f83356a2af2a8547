// Convex quadratic programs with bounds 0..1, to full accuracy: the engine of the skinning weights.
#pragma once

#include "core/vector.h"
#include "linear/supernodal_cholesky.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>

namespace limber::bake {

struct BoundedQuadraticReport {
  int iterations = 0;
  // Largest entry of x - clamp(x - gradient / gradient_scale, 0, 1), over the variables held at
  // zero as well: zero exactly at the optimum.
  double stationarity = 0;
  // Upper bound on the excess of the objective over its minimum in the variables that are not held,
  // relative to the objective's size ½ x^T Q x + |c^T x|, or to a millionth of the largest |c_i|
  // where that is smaller.
  double gap = 0;
  bool converged = false;
};

// min ½ x^T Q x + c^T x subject to 0 <= x <= 1, for symmetric positive definite Q given whole.
// Mehrotra's predictor-corrector interior point method; one sparse factorisation an iteration.
// Const methods may be called from many threads at once.
class BoundedQuadratic {
 public:
  explicit BoundedQuadratic(const Eigen::SparseMatrix<double>& Q);

  // The others of the n variables are held at zero, and cost nothing; it is up to the caller to
  // know that zero is where their optimum lies, and to the report to say whether it does.
  // variables: ascending. order: [n], the place of each column of Q in a good order of elimination.
  BoundedQuadratic(const Eigen::SparseMatrix<double>& Q, const Vector<int>& order,
                   Vector<int> variables);

  // c, x: [n]. `keep_going` is asked before each iteration; false stops with converged == false.
  // `x` holds the last iterate in any case, inside the bounds.
  BoundedQuadraticReport Solve(const Eigen::VectorXd& c, const std::function<bool()>& keep_going,
                               Eigen::VectorXd* x) const;

 private:
  Vector<int> variables_, held_;
  Eigen::SparseMatrix<double> Q_;      // variables x variables
  Eigen::SparseMatrix<double> pulls_;  // held x variables
  linear::SupernodalCholesky cholesky_;
};

}  // namespace limber::bake
