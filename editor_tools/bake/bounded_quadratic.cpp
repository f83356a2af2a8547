#include "bake/bounded_quadratic.h"

#include "core/vector.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace limber::bake {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::SparseMatrix;
using Eigen::VectorXd;

constexpr int kMaxIterations = 60;
constexpr double kGapTolerance = 1e-12;
constexpr double kDualTolerance = 1e-8;
constexpr double kStationarityTolerance = 1e-8;
// From this gap on, what is rightly held at zero has a residual that is larger than those of the
// others by some ten times, and falls as they do.
constexpr double kGapOfHeld = 1e-10, kHeldToInside = 100;
constexpr double kStepToBoundary = 0.995;
// Of the largest gradient at zero: what the gap is relative to where the optimum is zero.
constexpr double kSmallestObjective = 1e-6;

// The start: so far inside the bounds, and such a product of distance and multiplier there.
constexpr double kStartMargin = 0.02, kStartProduct = 1e-3;
constexpr double kStartDiagonal = 1e-12;  // what keeps the unbounded problem definite

// A primal point with its distances to both bounds and their multipliers; all of them positive.
struct Iterate {
  ArrayXd x, t;  // t = 1 - x, kept apart because the difference loses the digits near 1
  ArrayXd z, v;  // multipliers of x >= 0 and t >= 0

  double Complementarity() const { return (x * z).sum() + (t * v).sum(); }
};

struct Step {
  ArrayXd x, z, v;  // t moves by -x
};

// Lowers a fraction to the largest that keeps `value` + sign fraction `step` positive.
void LimitToBoundary(const ArrayXd& value, const ArrayXd& step, double sign, double* fraction) {
  for (Index i = 0; i < value.size(); ++i) {
    const double change = sign * step(i);
    if (change < 0) *fraction = std::min(*fraction, -value(i) / change);
  }
}

// The largest fraction, up to 1.
double FractionToBoundary(const Iterate& at, const Step& step) {
  double fraction = 1;
  LimitToBoundary(at.x, step.x, 1, &fraction);
  LimitToBoundary(at.t, step.x, -1, &fraction);
  LimitToBoundary(at.z, step.z, 1, &fraction);
  LimitToBoundary(at.v, step.v, 1, &fraction);
  return fraction;
}

// What the complementarity would be after that fraction of the step.
double ComplementarityAfter(const Iterate& at, const Step& step, double fraction) {
  return ((at.x + fraction * step.x) * (at.z + fraction * step.z) +
          (at.t - fraction * step.x) * (at.v + fraction * step.v))
      .sum();
}

void Move(const Step& step, double fraction, Iterate* at) {
  at->x += fraction * step.x;
  at->t -= fraction * step.x;
  at->z += fraction * step.z;
  at->v += fraction * step.v;
}

struct Problem {
  const SparseMatrix<double>& Q;
  const linear::SupernodalCholesky& cholesky;
  const SparseMatrix<double>& pulls;  // of the variables on those held at zero
  VectorXd c, held_c;
};

// One call's work, in units in which the largest gradient at zero is one.
class Solver {
 public:
  Solver(const Problem& problem, double scale)
      : problem_(problem),
        scale_(1 / scale),
        linear_(problem.c.array() / scale),
        held_linear_(problem.held_c.array() / scale) {}

  BoundedQuadraticReport Run(const std::function<bool()>& keep_going) {
    bool is_sound = Begin();
    UpdateGradient();
    while (!IsAtItsEnd() && is_sound && keep_going()) {
      is_sound = TakeStep();
      UpdateGradient();
    }
    return report_;
  }

  // The more exact of x and 1 - t, inside [0, 1].
  VectorXd Solution() const { return (at_.x < at_.t).select(at_.x, 1 - at_.t).matrix(); }

 private:
  // Where the problem without bounds has its optimum, brought inside them: near the middle of the
  // bounds nothing is known yet of what lies at which, and several steps are spent to find out.
  bool Begin() {
    diagonal_ = ArrayXd::Constant(linear_.size(), kStartDiagonal);
    at_.x = -linear_;
    const bool is_definite = FactoriseAndSolve(at_.x.data());
    if (!is_definite) at_.x.setConstant(0.5);
    at_.x = at_.x.max(kStartMargin).min(1 - kStartMargin);
    at_.t = 1 - at_.x;
    at_.z = at_.v = ArrayXd::Zero(linear_.size());
    UpdateGradient();
    at_.z = gradient_.max(0.0) + kStartProduct / at_.x;
    at_.v = (-gradient_).max(0.0) + kStartProduct / at_.t;
    return is_definite;
  }

  // Of Q and diagonal_; whether they are positive definite.
  bool FactoriseAndSolve(double* x) {
    problem_.cholesky.FactoriseAndSolve(scale_, diagonal_.data(), &factor_, x);
    return factor_.definite;
  }

  void UpdateGradient() {
    product_.noalias() = problem_.Q * at_.x.matrix();
    gradient_ = scale_ * product_.array() + linear_;
    dual_residual_ = gradient_ - at_.z + at_.v;
    complementarity_ = at_.Complementarity();
    size_ = std::max(
        0.5 * scale_ * (at_.x * product_.array()).sum() + std::abs((linear_ * at_.x).sum()),
        kSmallestObjective);
  }

  // How far a step down the gradient would take those held at zero.
  double HeldResidual() const {
    if (held_linear_.size() == 0) return 0;
    const VectorXd pulls = problem_.pulls * at_.x.matrix();
    return (-(scale_ * pulls.array() + held_linear_)).max(0.0).min(1.0).maxCoeff();
  }

  // Fills the report.
  bool IsAtItsEnd() {
    const double inside = (at_.x - (at_.x - gradient_).max(0.0).min(1.0)).abs().maxCoeff();
    const double held = HeldResidual();
    report_.gap = complementarity_ / size_;
    report_.stationarity = std::max(inside, held);
    report_.converged = report_.gap <= kGapTolerance &&
                        dual_residual_.abs().maxCoeff() <= kDualTolerance &&
                        report_.stationarity <= kStationarityTolerance;
    const bool is_held_wrongly =
        report_.gap <= kGapOfHeld && held > kStationarityTolerance && held > kHeldToInside * inside;
    return report_.converged || is_held_wrongly || report_.iterations == kMaxIterations;
  }

  // The Newton step towards x z = lower and t v = upper (elementwise), by elimination of the
  // multipliers: (Q + z/x + v/t) dx = -dual residual + (lower/x - z) - (upper/t - v), for which
  // `solve` is called with the right side in step->x. lower, upper: array expressions.
  template <class Lower, class Upper, class Solve>
  void FindStep(const Lower& lower, const Upper& upper, const Solve& solve, Step* step) const {
    step->x = (lower / at_.x - at_.z) - (upper / at_.t - at_.v) - dual_residual_;
    solve(step->x.data());
    step->z = lower / at_.x - at_.z - at_.z / at_.x * step->x;
    step->v = upper / at_.t - at_.v + at_.v / at_.t * step->x;
  }

  // Whether there was one to take: the system definite, the step finite.
  bool TakeStep() {
    ++report_.iterations;
    diagonal_ = at_.z / at_.x + at_.v / at_.t;
    const auto zero = ArrayXd::Zero(at_.x.size());
    bool is_definite = false;
    FindStep(
        zero, zero, [&](double* x) { is_definite = FactoriseAndSolve(x); }, &affine_);
    if (!is_definite) return false;
    const double count = static_cast<double>(2 * at_.x.size());
    const double mu = complementarity_ / count;
    const double mu_affine =
        ComplementarityAfter(at_, affine_, FractionToBoundary(at_, affine_)) / count;
    const double centred = mu * std::pow(mu_affine / mu, 3);
    FindStep(
        centred - affine_.x * affine_.z, centred + affine_.x * affine_.v,
        [this](double* x) { problem_.cholesky.Solve(&factor_, x); }, &step_);
    if (!step_.x.allFinite() || !step_.z.allFinite() || !step_.v.allFinite()) return false;
    Move(step_, std::min(kStepToBoundary * FractionToBoundary(at_, step_), 1.0), &at_);
    return true;
  }

  const Problem& problem_;
  double scale_;  // of Q
  ArrayXd linear_, held_linear_;
  Iterate at_;
  Step affine_, step_;
  VectorXd product_;
  ArrayXd gradient_, dual_residual_, diagonal_;
  double complementarity_ = 0, size_ = 0;
  linear::SupernodalCholesky::Factor factor_;
  BoundedQuadraticReport report_;
};

Vector<int> AllBut(const Vector<int>& variables, Index n) {
  Vector<int> others;
  auto next = variables.begin();
  for (int i = 0; i < n; ++i) {
    const bool is_variable = next != variables.end() && *next == i;
    if (is_variable) ++next;
    if (!is_variable) others.push_back(i);
  }
  return others;
}

// Some rows and columns of Q, both ascending.
SparseMatrix<double> PartOf(const SparseMatrix<double>& Q, const Vector<int>& rows,
                            const Vector<int>& columns) {
  Vector<int> place(static_cast<size_t>(Q.rows()), -1);
  for (size_t i = 0; i < rows.size(); ++i)
    place[static_cast<size_t>(rows[i])] = static_cast<int>(i);
  Vector<Eigen::Triplet<double>> entries;
  for (size_t column = 0; column < columns.size(); ++column) {
    for (SparseMatrix<double>::InnerIterator it(Q, columns[column]); it; ++it) {
      const int row = place[static_cast<size_t>(it.row())];
      if (row >= 0) entries.emplace_back(row, static_cast<int>(column), it.value());
    }
  }
  SparseMatrix<double> part(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

// [variables]: their places among each other, in the order of all.
Vector<int> OrderAmong(const Vector<int>& variables, const Vector<int>& order) {
  Vector<int> sorted(variables.size()), places(variables.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  const auto place_of = [&](int i) {
    return order[static_cast<size_t>(variables[static_cast<size_t>(i)])];
  };
  std::sort(sorted.begin(), sorted.end(), [&](int a, int b) { return place_of(a) < place_of(b); });
  for (size_t place = 0; place < sorted.size(); ++place)
    places[static_cast<size_t>(sorted[place])] = static_cast<int>(place);
  return places;
}

}  // namespace

BoundedQuadratic::BoundedQuadratic(const SparseMatrix<double>& Q)
    : variables_(static_cast<size_t>(Q.cols())),
      Q_(Q),
      pulls_(0, Q.cols()),
      cholesky_(Q) {
  std::iota(variables_.begin(), variables_.end(), 0);
}

BoundedQuadratic::BoundedQuadratic(const SparseMatrix<double>& Q, const Vector<int>& order,
                                   Vector<int> variables)
    : variables_(std::move(variables)),
      held_(AllBut(variables_, Q.cols())),
      Q_(PartOf(Q, variables_, variables_)),
      pulls_(PartOf(Q, held_, variables_)),
      cholesky_(Q_, linear::Eliminate(Q_, OrderAmong(variables_, order))) {}

BoundedQuadraticReport BoundedQuadratic::Solve(const VectorXd& c,
                                               const std::function<bool()>& keep_going,
                                               VectorXd* x) const {
  *x = VectorXd::Zero(c.size());
  const double scale = c.size() > 0 ? c.lpNorm<Eigen::Infinity>() : 0;
  BoundedQuadraticReport report;
  report.converged = scale == 0;  // nothing pulls: zero is the optimum
  if (!(scale > 0)) return report;
  if (variables_.empty()) {
    report.stationarity = std::max(-c.minCoeff() / scale, 0.0);
    report.converged = report.stationarity <= kStationarityTolerance;
    return report;
  }
  const Problem problem{Q_, cholesky_, pulls_, c(variables_), c(held_)};
  Solver solver(problem, scale);
  report = solver.Run(keep_going);
  (*x)(variables_) = solver.Solution();
  return report;
}

}  // namespace limber::bake
