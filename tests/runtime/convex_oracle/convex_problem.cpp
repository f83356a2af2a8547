#include "runtime/convex_oracle/convex_problem.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace limber::oracle {
namespace {

// Of dual . (J x - j) + linear . x over the simplices.
double LowerBound(const ConvexProblem& problem, Eigen::Index shapes, const Eigen::VectorXd& dual) {
  const Eigen::VectorXd slope = problem.factor.transpose() * dual + problem.linear;
  double bound = -dual.dot(problem.goal);
  for (Eigen::Index first = 0; first < slope.size(); first += shapes)
    bound += slope.segment(first, shapes).minCoeff();
  return bound;
}

// The dual vector nearest to `dual` with equal slopes at the weights in use, |u| <= 1 kept.
Eigen::VectorXd EqualiseSlopes(const ConvexProblem& problem, Eigen::Index shapes,
                               const Eigen::VectorXd& blend, const Eigen::VectorXd& dual) {
  Eigen::MatrixXd differences(blend.size(), dual.size());
  Eigen::VectorXd right(blend.size());
  Eigen::Index count = 0;
  for (Eigen::Index first = 0; first < blend.size(); first += shapes) {
    Eigen::Index most = 0;
    blend.segment(first, shapes).maxCoeff(&most);
    most += first;
    for (Eigen::Index i = first; i < first + shapes; ++i) {
      if (i == most || blend[i] == 0) continue;
      differences.row(count) = (problem.factor.col(i) - problem.factor.col(most)).transpose();
      right[count] = problem.linear[most] - problem.linear[i] - differences.row(count).dot(dual);
      ++count;
    }
  }
  Eigen::VectorXd equal = dual;
  if (count > 0) {
    equal += differences.topRows(count).completeOrthogonalDecomposition().solve(right.head(count));
  }
  return equal / std::max(1.0, std::sqrt(2.0) * equal.norm());
}

}  // namespace

double ConvexProblem::F(const Eigen::VectorXd& x) const {
  return 0.5 * (factor * x - goal).squaredNorm();
}

double ConvexProblem::Objective(const Eigen::VectorXd& x) const {
  return (square_root ? std::sqrt(F(x)) : F(x)) + linear.dot(x);
}

void AddSimplices(Eigen::Index shapes, ConvexProblem* problem) {
  const Eigen::Index size = problem->linear.size(), before = problem->equality.rows();
  const Eigen::Index groups = (size - problem->first_bounded) / shapes;
  problem->equality.conservativeResize(before + groups, size);
  problem->equality.bottomRows(groups).setZero();
  problem->right.conservativeResize(before + groups);
  problem->right.tail(groups).setOnes();
  for (Eigen::Index g = 0; g < groups; ++g) {
    problem->equality.row(before + g)
        .segment(problem->first_bounded + g * shapes, shapes)
        .setOnes();
  }
}

Certificate Certify(const ConvexProblem& problem, Eigen::Index shapes, double delta_squared,
                    const Eigen::VectorXd& blend) {
  Certificate certificate;
  certificate.infeasibility = std::max(0.0, -blend.minCoeff());
  for (Eigen::Index first = 0; first < blend.size(); first += shapes) {
    certificate.infeasibility =
        std::max(certificate.infeasibility, std::abs(blend.segment(first, shapes).sum() - 1));
  }
  certificate.objective = problem.Objective(blend);
  const Eigen::VectorXd residual = problem.factor * blend - problem.goal;
  if (!problem.square_root) {
    certificate.lower_bound = LowerBound(problem, shapes, residual) - 0.5 * residual.squaredNorm();
    return certificate;
  }
  const double f = 0.5 * residual.squaredNorm();
  const Eigen::VectorXd dual = 0.5 / std::sqrt(f + delta_squared) * residual;
  certificate.lower_bound =
      std::max(LowerBound(problem, shapes, dual),
               LowerBound(problem, shapes, EqualiseSlopes(problem, shapes, blend, dual)));
  return certificate;
}

}  // namespace limber::oracle
