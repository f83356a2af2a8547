// Stands in where the build found no Ipopt.
#include "runtime/convex_oracle/ipopt_solver.h"

namespace limber::oracle {

struct IpoptSolver::State {};

bool IpoptSolver::IsAvailable() {
  return false;
}

IpoptSolver::IpoptSolver(Form /*form*/, double /*tolerance*/) {}

IpoptSolver::~IpoptSolver() = default;

IpoptAnswer IpoptSolver::Solve(const ConvexProblem& /*problem*/, const Eigen::VectorXd& /*start*/,
                               bool /*warm*/) {
  return {};
}

}  // namespace limber::oracle
