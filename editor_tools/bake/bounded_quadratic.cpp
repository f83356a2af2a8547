#include "bake/bounded_quadratic.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <utility>

namespace limber::bake {
namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;
using Cholesky = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;

constexpr int kMaxIterations = 60;
constexpr double kGapTolerance = 1e-12;
constexpr double kDualTolerance = 1e-8;
constexpr double kStationarityTolerance = 1e-8;
constexpr double kStepToBoundary = 0.995;

// Primal point with its distances to both bounds and their multipliers; all of them positive.
struct Iterate {
  ArrayXd x, t;  // t = 1 - x, kept apart because the difference loses the digits near 1
  ArrayXd z, v;  // multipliers of x >= 0 and t >= 0

  double Complementarity() const { return (x * z).sum() + (t * v).sum(); }
};

struct Step {
  ArrayXd x, z, v;  // t moves by -x
};

// Largest fraction of `step`, up to 1, that keeps `value` positive.
double FractionToBoundary(const ArrayXd& value, const ArrayXd& step) {
  double fraction = 1;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    if (step(i) < 0) fraction = std::min(fraction, -value(i) / step(i));
  }
  return fraction;
}

double FractionToBoundary(const Iterate& at, const Step& step) {
  return std::min({FractionToBoundary(at.x, step.x), FractionToBoundary(at.t, -step.x),
                   FractionToBoundary(at.z, step.z), FractionToBoundary(at.v, step.v)});
}

Iterate Moved(const Iterate& at, const Step& step, double fraction) {
  return {at.x + fraction * step.x, at.t - fraction * step.x, at.z + fraction * step.z,
          at.v + fraction * step.v};
}

// Factors Q + diag(extra); false where that is not positive definite.
bool Factorise(Eigen::SparseMatrix<double> Q, const ArrayXd& extra, Cholesky* factor) {
  for (Eigen::Index i = 0; i < extra.size(); ++i)
    Q.coeffRef(i, i) += extra(i);
  factor->factorize(Q);
  return factor->info() == Eigen::Success;
}

// The Newton step towards x z = lower and t v = upper (elementwise), by elimination of the
// multipliers: (Q + z/x + v/t) dx = -dual residual + (lower/x - z) - (upper/t - v).
Step SolveStep(const Cholesky& factor, const Iterate& at, const ArrayXd& dual_residual,
               const ArrayXd& lower, const ArrayXd& upper) {
  const ArrayXd to_z = lower / at.x - at.z;
  const ArrayXd to_v = upper / at.t - at.v;
  Step step;
  step.x = factor.solve((-dual_residual + to_z - to_v).matrix()).array();
  step.z = to_z - at.z / at.x * step.x;
  step.v = to_v + at.v / at.t * step.x;
  return step;
}

}  // namespace

void BoundedQuadratic::Solve(const VectorXd& c, const std::function<bool()>& keep_going,
                             VectorXd* x, BoundedQuadraticReport* report) const {
  *report = {};
  const Eigen::Index n = c.size();
  *x = VectorXd::Zero(n);
  const double scale = n > 0 ? c.lpNorm<Eigen::Infinity>() : 0;
  if (!(scale > 0)) {  // nothing pulls: zero is the optimum
    report->converged = scale == 0;
    return;
  }
  // In units in which the largest gradient at zero is one.
  const Eigen::SparseMatrix<double> Q = Q_ / scale;
  const ArrayXd linear = c.array() / scale;
  Cholesky factor;
  factor.analyzePattern(Q);
  Iterate at{ArrayXd::Constant(n, 0.5), ArrayXd::Constant(n, 0.5), ArrayXd::Ones(n),
             ArrayXd::Ones(n)};
  for (;; ++report->iterations) {
    const ArrayXd Qx = (Q * at.x.matrix()).array();
    const ArrayXd gradient = Qx + linear;
    const ArrayXd dual_residual = gradient - at.z + at.v;
    const double size = 0.5 * (at.x * Qx).sum() + std::abs((linear * at.x).sum());
    report->gap = at.Complementarity() / size;
    report->stationarity =
        (at.x - (at.x - gradient).max(0.0).min(1.0)).matrix().lpNorm<Eigen::Infinity>();
    report->converged = report->gap <= kGapTolerance &&
                        dual_residual.abs().maxCoeff() <= kDualTolerance &&
                        report->stationarity <= kStationarityTolerance;
    if (report->converged || report->iterations == kMaxIterations || !keep_going()) break;

    if (!Factorise(Q, at.z / at.x + at.v / at.t, &factor)) break;
    const ArrayXd zero = ArrayXd::Zero(n);
    const Step affine = SolveStep(factor, at, dual_residual, zero, zero);
    const double mu = at.Complementarity() / static_cast<double>(2 * n);
    const double mu_affine = Moved(at, affine, FractionToBoundary(at, affine)).Complementarity() /
                             static_cast<double>(2 * n);
    const double centred = mu * std::pow(mu_affine / mu, 3);
    const Step step = SolveStep(factor, at, dual_residual, centred - affine.x * affine.z,
                                centred + affine.x * affine.v);
    const double fraction = FractionToBoundary(at, step);
    Iterate next = Moved(at, step, std::min(1.0, kStepToBoundary * fraction));
    if (!next.x.allFinite() || !next.z.allFinite() || !next.v.allFinite()) break;
    at = std::move(next);
  }
  *x = (at.x < at.t).select(at.x, 1 - at.t).matrix();  // the more exact of the two, inside [0, 1]
}

}  // namespace limber::bake
