#include "bake/bounded_quadratic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace limber::bake {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kMaxIterations = 60;
constexpr double kGapTolerance = 1e-12;
constexpr double kDualTolerance = 1e-8;
constexpr double kStationarityTolerance = 1e-8;
constexpr double kStepToBoundary = 0.995;
// Of the largest gradient at zero: what the gap is relative to where the optimum is zero.
constexpr double kSmallestObjective = 1e-6;

// The start: so far inside the bounds, and such a product of distance and multiplier there.
constexpr double kStartMargin = 0.02, kStartProduct = 1e-3;
constexpr double kStartDiagonal = 1e-12;  // what keeps the unbounded problem definite

// Arrays are lanes x n: a problem a row. Rows never meet, and sums run along them in one order, so
// that a row's bits do not depend on the others.

ArrayXd SumOfProducts(const ArrayXXd& a, const ArrayXXd& b) {
  ArrayXd sums = ArrayXd::Zero(a.rows());
  for (Index i = 0; i < a.cols(); ++i)
    sums += a.col(i) * b.col(i);
  return sums;
}

// Primal points with their distances to both bounds and their multipliers; all of them positive.
struct Iterate {
  ArrayXXd x, t;  // t = 1 - x, kept apart because the difference loses the digits near 1
  ArrayXXd z, v;  // multipliers of x >= 0 and t >= 0

  ArrayXd Complementarity() const { return SumOfProducts(x, z) + SumOfProducts(t, v); }
};

struct Step {
  ArrayXXd x, z, v;  // t moves by -x
};

// Lowers fractions to the largest that keep `value` + sign fraction `step` positive.
void LimitToBoundary(const ArrayXXd& value, const ArrayXXd& step, double sign, ArrayXd* fractions) {
  for (Index i = 0; i < value.cols(); ++i) {
    for (Index lane = 0; lane < value.rows(); ++lane) {
      const double change = sign * step(lane, i);
      if (change < 0) (*fractions)(lane) = std::min((*fractions)(lane), -value(lane, i) / change);
    }
  }
}

// Largest fractions, up to 1.
ArrayXd FractionsToBoundary(const Iterate& at, const Step& step) {
  ArrayXd fractions = ArrayXd::Ones(at.x.rows());
  LimitToBoundary(at.x, step.x, 1, &fractions);
  LimitToBoundary(at.t, step.x, -1, &fractions);
  LimitToBoundary(at.z, step.z, 1, &fractions);
  LimitToBoundary(at.v, step.v, 1, &fractions);
  return fractions;
}

// What the complementarity would be after those fractions of the step.
ArrayXd ComplementarityAfter(const Iterate& at, const Step& step, const ArrayXd& fractions) {
  ArrayXd sums = ArrayXd::Zero(at.x.rows());
  for (Index i = 0; i < at.x.cols(); ++i) {
    const auto dx = fractions * step.x.col(i);
    sums += (at.x.col(i) + dx) * (at.z.col(i) + fractions * step.z.col(i)) +
            (at.t.col(i) - dx) * (at.v.col(i) + fractions * step.v.col(i));
  }
  return sums;
}

void Move(const Step& step, const ArrayXd& fractions, Iterate* at) {
  at->x += step.x.colwise() * fractions;
  at->t -= step.x.colwise() * fractions;
  at->z += step.z.colwise() * fractions;
  at->v += step.v.colwise() * fractions;
}

// One call's work: all its problems in units in which the largest gradient at zero is one.
class LaneSolver {
 public:
  LaneSolver(const Eigen::SparseMatrix<double>& Q, const LaneCholesky& cholesky, const MatrixXd& c,
             MatrixXd* x, std::vector<BoundedQuadraticReport>* reports)
      : Q_(Q),
        cholesky_(cholesky),
        x_(*x),
        reports_(*reports),
        num_lanes_(c.cols() <= LaneCholesky::kFew ? LaneCholesky::kFew : LaneCholesky::kMany) {
    const Index n = c.rows();
    x_ = MatrixXd::Zero(n, c.cols());
    reports_.assign(static_cast<size_t>(c.cols()), {});
    linear_ = ArrayXXd::Zero(num_lanes_, n);
    problems_.fill(-1);
    for (Index lane = 0; lane < c.cols(); ++lane) {
      const double scale = n > 0 ? c.col(lane).lpNorm<Eigen::Infinity>() : 0;
      const auto l = static_cast<size_t>(lane);
      is_active_[l] = scale > 0;
      if (!is_active_[l]) {  // nothing pulls: zero is the optimum
        reports_[l].converged = scale == 0;
        continue;
      }
      problems_[l] = lane;
      scales_[l] = 1 / scale;
      linear_.row(lane) = c.col(lane).transpose().array() / scale;
    }
  }

  void Run(const std::function<bool()>& keep_going) {
    Begin();
    while (true) {
      UpdateGradients();
      for (size_t lane = 0; lane < is_active_.size(); ++lane) {
        if (is_active_[lane]) is_active_[lane] = !IsAtItsEnd(lane);
      }
      const auto active = std::count(is_active_.begin(), is_active_.end(), true);
      if (active == 0 || !keep_going()) break;
      if (active <= LaneCholesky::kFew && num_lanes_ > LaneCholesky::kFew) GatherActive();
      TakeStep();
    }
    for (Index lane = 0; lane < num_lanes_; ++lane)
      StoreSolution(lane);
  }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  BoundedQuadraticReport& report(size_t lane) {
    return reports_[static_cast<size_t>(problems_[lane])];
  }

  // The more exact of x and 1 - t, inside [0, 1].
  void StoreSolution(Index lane) {
    const Index problem = problems_[static_cast<size_t>(lane)];
    if (problem < 0) return;
    const auto x = at_.x.row(lane), t = at_.t.row(lane);
    x_.col(problem) = (x < t).select(x, 1 - t).matrix().transpose();
  }

  // Few are left: they move to the first lanes, and the others are no longer worked on.
  void GatherActive() {
    Index to = 0;
    for (Index lane = 0; lane < num_lanes_; ++lane) {
      const auto from = static_cast<size_t>(lane);
      if (!is_active_[from]) {
        StoreSolution(lane);
        problems_[from] = -1;
        continue;
      }
      const auto place = static_cast<size_t>(to);
      for (ArrayXXd* rows : {&at_.x, &at_.t, &at_.z, &at_.v, &linear_})
        rows->row(to) = rows->row(lane).eval();
      std::swap(problems_[place], problems_[from]);
      std::swap(is_active_[place], is_active_[from]);
      std::swap(scales_[place], scales_[from]);
      ++to;
    }
    num_lanes_ = LaneCholesky::kFew;
    for (ArrayXXd* rows : {&at_.x, &at_.t, &at_.z, &at_.v, &linear_})
      *rows = rows->topRows(num_lanes_).eval();
    UpdateGradients();
  }

  // Where the problem without bounds has its optimum, brought inside them: near the middle of the
  // bounds nothing is known yet of what lies at which, and several steps are spent to find out.
  void Begin() {
    diagonal_ = ArrayXXd::Constant(num_lanes_, linear_.cols(), kStartDiagonal);
    at_.x = -linear_;
    FactoriseAndSolve(at_.x.data());
    for (Index lane = 0; lane < num_lanes_; ++lane) {
      if (!is_active_[static_cast<size_t>(lane)]) at_.x.row(lane).setConstant(0.5);
    }
    at_.x = at_.x.max(kStartMargin).min(1 - kStartMargin);
    at_.t = 1 - at_.x;
    at_.z = at_.v = ArrayXXd::Zero(num_lanes_, linear_.cols());
    UpdateGradients();
    at_.z = gradient_.max(0.0) + kStartProduct / at_.x;
    at_.v = (-gradient_).max(0.0) + kStartProduct / at_.t;
  }

  // Of Q and diagonal_, the latter one where a lane is at rest; a lane that is not definite rests.
  void FactoriseAndSolve(double* x) {
    std::array<double, LaneCholesky::kMany> scales = scales_;
    for (Index lane = 0; lane < num_lanes_; ++lane) {
      if (is_active_[static_cast<size_t>(lane)]) continue;
      diagonal_.row(lane).setOnes();
      scales[static_cast<size_t>(lane)] = 0;
    }
    cholesky_.FactoriseAndSolve(scales.data(), diagonal_.data(), num_lanes_, &factor_, x);
    for (size_t lane = 0; lane < is_active_.size(); ++lane)
      is_active_[lane] = is_active_[lane] && factor_.definite[lane];
  }

  void UpdateGradients() {
    const Eigen::Map<const RowMajor> x(at_.x.data(), at_.x.cols(), num_lanes_);
    product_.noalias() = Q_ * x;
    Qx_ = Eigen::Map<const ArrayXXd>(product_.data(), num_lanes_, at_.x.cols()).colwise() *
          Eigen::Map<const ArrayXd>(scales_.data(), num_lanes_);
    gradient_ = Qx_ + linear_;
    dual_residual_ = gradient_ - at_.z + at_.v;
    complementarity_ = at_.Complementarity();
    sizes_ = (0.5 * SumOfProducts(at_.x, Qx_) + SumOfProducts(linear_, at_.x).abs())
                 .max(kSmallestObjective);
  }

  // Fills the lane's report.
  bool IsAtItsEnd(size_t lane) {
    BoundedQuadraticReport& report = this->report(lane);
    const auto row = static_cast<Index>(lane);
    const auto x = at_.x.row(row);
    report.gap = complementarity_(row) / sizes_(row);
    report.stationarity = (x - (x - gradient_.row(row)).max(0.0).min(1.0)).abs().maxCoeff();
    report.converged = report.gap <= kGapTolerance &&
                       dual_residual_.row(row).abs().maxCoeff() <= kDualTolerance &&
                       report.stationarity <= kStationarityTolerance;
    return report.converged || report.iterations == kMaxIterations;
  }

  // The Newton step towards x z = lower and t v = upper (elementwise), by elimination of the
  // multipliers: (Q + z/x + v/t) dx = -dual residual + (lower/x - z) - (upper/t - v), for which
  // `solve` is called with the right sides in step->x. lower, upper: array expressions.
  template <class Lower, class Upper, class Solve>
  void FindStep(const Lower& lower, const Upper& upper, const Solve& solve, Step* step) const {
    step->x = (lower / at_.x - at_.z) - (upper / at_.t - at_.v) - dual_residual_;
    solve(step->x.data());
    step->z = lower / at_.x - at_.z - at_.z / at_.x * step->x;
    step->v = upper / at_.t - at_.v + at_.v / at_.t * step->x;
  }

  // Lanes at rest are worked on along with the others, to no effect.
  void TakeStep() {
    for (size_t lane = 0; lane < is_active_.size(); ++lane) {
      if (is_active_[lane]) ++report(lane).iterations;
    }
    diagonal_ = at_.z / at_.x + at_.v / at_.t;
    const auto zero = ArrayXXd::Zero(num_lanes_, at_.x.cols());
    FindStep(
        zero, zero, [this](double* x) { FactoriseAndSolve(x); }, &affine_);
    const double count = static_cast<double>(2 * at_.x.cols());
    const ArrayXd mu = complementarity_ / count;
    const ArrayXd mu_affine =
        ComplementarityAfter(at_, affine_, FractionsToBoundary(at_, affine_)) / count;
    const ArrayXd centred = mu * (mu_affine / mu).cube();
    FindStep((-affine_.x * affine_.z).colwise() + centred,
             (affine_.x * affine_.v).colwise() + centred,
             [this](double* x) { cholesky_.Solve(&factor_, x); }, &step_);
    ArrayXd fractions = (kStepToBoundary * FractionsToBoundary(at_, step_)).min(1.0);
    LimitToActive(&fractions);
    Move(step_, fractions, &at_);
  }

  // Lanes at rest do not move, and lanes whose step is not finite rest from now on.
  void LimitToActive(ArrayXd* fractions) {
    ArrayXd nothing = ArrayXd::Zero(num_lanes_);  // or not a number
    for (Index i = 0; i < step_.x.cols(); ++i) {
      nothing += (step_.x.col(i) - step_.x.col(i)) + (step_.z.col(i) - step_.z.col(i)) +
                 (step_.v.col(i) - step_.v.col(i));
    }
    for (Index lane = 0; lane < num_lanes_; ++lane) {
      bool& is_active = is_active_[static_cast<size_t>(lane)];
      is_active = is_active && nothing(lane) == 0;
      if (!is_active) (*fractions)(lane) = 0;
      for (ArrayXXd* rows : {&step_.x, &step_.z, &step_.v}) {
        if (nothing(lane) != 0) rows->row(lane).setZero();
      }
    }
  }

  const Eigen::SparseMatrix<double>& Q_;
  const LaneCholesky& cholesky_;
  MatrixXd& x_;
  std::vector<BoundedQuadraticReport>& reports_;
  int num_lanes_;
  std::array<Index, LaneCholesky::kMany> problems_ = {};  // column of c in each lane, -1 for none
  std::array<double, LaneCholesky::kMany> scales_ = {};   // of Q; zero where nothing pulls
  std::array<bool, LaneCholesky::kMany> is_active_ = {};
  ArrayXXd linear_;  // c
  Iterate at_;
  Step affine_, step_;
  RowMajor product_;
  ArrayXXd Qx_, gradient_, dual_residual_, diagonal_;
  ArrayXd complementarity_, sizes_;
  LaneCholesky::Factor factor_;
};

}  // namespace

BoundedQuadratic::BoundedQuadratic(const Eigen::SparseMatrix<double>& Q) : Q_(Q), cholesky_(Q) {}

void BoundedQuadratic::Solve(const MatrixXd& c, const std::function<bool()>& keep_going,
                             MatrixXd* x, std::vector<BoundedQuadraticReport>* reports) const {
  LaneSolver(Q_, cholesky_, c, x, reports).Run(keep_going);
}

}  // namespace limber::bake
