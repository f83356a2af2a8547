// The convex step (eq. 20 of Wampler 2016) as a general optimiser sees it, and what certifies an
// answer. Plain and dense: an oracle for tests and benchmarks, never part of what ships.
//
//     minimise   sqrt(f(x)) + linear . x   or   f(x) + linear . x,     f(x) = 1/2 |J x - j|^2
//     subject to equality x = right,   x[first_bounded ...] >= 0
#pragma once

#include <Eigen/Core>

namespace limber::oracle {

struct ConvexProblem {
  Eigen::MatrixXd factor;  // J
  Eigen::VectorXd goal;    // j
  Eigen::VectorXd linear;  // as long as x
  Eigen::MatrixXd equality;
  Eigen::VectorXd right;
  Eigen::Index first_bounded = 0;
  bool square_root = true;

  double F(const Eigen::VectorXd& x) const;
  double Objective(const Eigen::VectorXd& x) const;
};

// Adds rows to `equality`: every `shapes` consecutive bounded unknowns sum to one.
void AddSimplices(Eigen::Index shapes, ConvexProblem* problem);

struct Certificate {
  double infeasibility = 0;  // largest violation of a bound, or of a sum being one
  double objective = 0;
  double lower_bound = 0;  // of the objective over all feasible x
};

// For problems whose unknowns are blend weights alone, in groups of `shapes`, all bounded.
//
// The certificate is Lagrange's: with a dual vector u, |u| <= 1,
//     sqrt(f(x)) = max_u u . (J x - j) / sqrt(2)
// so for all feasible x the objective is at least
//     -u . j / sqrt(2) + sum over groups of min_s (J^T u / sqrt(2) + linear)_gs,
// the minima being the multipliers of the sums, whatever u is. The best u is r / |r| of the
// residual r where sqrt(f) is smooth, and some element of the subdifferential at the kink f = 0.
// Two are tried and the better bound is kept: r / sqrt(2 (f + delta^2)), and the nearest one that
// gives the weights in use of a group the same slope, shortened to length one where it is longer.
// Without the square root u = r, less |u|^2 / 2.
Certificate Certify(const ConvexProblem& problem, Eigen::Index shapes, double delta_squared,
                    const Eigen::VectorXd& blend);

}  // namespace limber::oracle
