// Ipopt (interior point, exact derivatives) on a ConvexProblem. Where the build found no Ipopt,
// IsAvailable is false and nothing else may be called.
#pragma once

#include "runtime/convex_oracle/convex_problem.h"

#include <Eigen/Core>

#include <memory>

namespace limber::oracle {

struct IpoptAnswer {
  Eigen::VectorXd x;
  double objective = 0;  // of ConvexProblem, without any smoothing
  double seconds = 0;    // on the clock, in the optimiser alone
  int iterations = 0;
  bool converged = false;
};

class IpoptSolver {
 public:
  // How the optimiser is shown the square root. kSquareRoot: sqrt(f + delta^2), whose Hessian is
  // dense. kQuotient: sqrt(f) = min over r of (f / r + r) / 2 with r >= delta a further unknown,
  // jointly convex and as sparse as J^T J, which is worth several times. (Without the square root
  // both are the quadratic program.)
  enum class Form { kSquareRoot, kQuotient };

  static bool IsAvailable();

  // tolerance: of its scaled optimality conditions; its own default is 1e-8.
  IpoptSolver(Form form, double tolerance);
  ~IpoptSolver();

  // Starts from `start`; with the multipliers and the barrier of the last Solve if `warm` and there
  // was one of the same size.
  IpoptAnswer Solve(const ConvexProblem& problem, const Eigen::VectorXd& start, bool warm);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace limber::oracle
