#include "solve/stretch_limit.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

constexpr int kMaxIterations = 100, kMaxHalvings = 30, kMaxSweeps = 200;
constexpr double kTolerance = 1e-7;        // excess over a limit, of it, that is none
constexpr double kRegularisation = 1e-10;  // of the dual's Hessian, of its mean diagonal

size_t MostActive(size_t max_points) {
  const size_t all = max_points * (max_points - std::min<size_t>(max_points, 1)) / 2;
  return std::max<size_t>(1, std::min(all, 4 * max_points));
}

}  // namespace

StretchLimit::StretchLimit(size_t max_points)
    : kernels_(ChooseSolveKernels<3>()),
      max_points_(std::max<size_t>(max_points, 1)),
      stride_(PaddedSize(max_points_)),
      max_active_(MostActive(max_points_)),
      active_stride_(PaddedSize(max_active_)),
      weights_(max_points_),
      targets_(max_points_ * 3),
      x_(max_points_ * 3),
      factor_(stride_ * stride_),
      inverse_(stride_ * stride_),
      hessian_(active_stride_ * active_stride_),
      step_(active_stride_),
      slope_(active_stride_),
      column_(stride_) {
  pairs_.reserve(max_points_ * (max_points_ - 1) / 2);
  active_.reserve(pairs_.capacity());
}

void StretchLimit::CollectPairs(const Problem& problem, const double* points) {
  const size_t count = problem.handles.size(), k = problem.dimension;
  pairs_.clear();
  std::fill(targets_.begin(), targets_.end(), 0.0);
  for (size_t p = 0; p < count; ++p) {
    weights_[p] = problem.weights[static_cast<size_t>(problem.handles[p])];
    std::copy_n(points + p * k, k, targets_.begin() + static_cast<ptrdiff_t>(p * 3));
  }
  x_ = targets_;
  for (size_t b = 1; b < count; ++b) {
    const auto row = static_cast<size_t>(problem.handles[b]) * problem.num_handles;
    for (size_t a = 0; a < b; ++a) {
      const float reach = problem.reach[row + static_cast<size_t>(problem.handles[a])];
      if (reach > 0) pairs_.push_back({a, b, problem.limit * static_cast<double>(reach)});
    }
  }
}

// x of the multipliers and what follows from it; returns the dual's value.
double StretchLimit::Place(const Problem& problem, bool trial) {
  const size_t count = problem.handles.size(), stride = PaddedSize(count);
  std::fill_n(factor_.begin(), stride * stride, 0.0);
  const auto moves = [this](size_t point) { return std::isfinite(weights_[point]); };
  const auto entry = [&](size_t row, size_t column) -> double& {
    return factor_[std::min(row, column) * stride + std::max(row, column)];
  };
  for (size_t p = 0; p < count; ++p)
    entry(p, p) = moves(p) ? weights_[p] : 1;
  for (const Pair& pair : pairs_) {
    const double spring = trial ? pair.trial : pair.multiplier;
    if (moves(pair.a)) entry(pair.a, pair.a) += spring;
    if (moves(pair.b)) entry(pair.b, pair.b) += spring;
    if (moves(pair.a) && moves(pair.b)) entry(pair.a, pair.b) -= spring;
  }
  kernels_.cholesky_factor(factor_.data(), count, stride);
  for (size_t c = 0; c < problem.dimension; ++c) {
    std::fill_n(column_.begin(), stride, 0.0);
    for (size_t p = 0; p < count; ++p)
      column_[p] = (moves(p) ? weights_[p] : 1) * targets_[p * 3 + c];
    for (const Pair& pair : pairs_) {
      const double spring = trial ? pair.trial : pair.multiplier;
      if (moves(pair.a) && !moves(pair.b)) column_[pair.a] += spring * targets_[pair.b * 3 + c];
      if (moves(pair.b) && !moves(pair.a)) column_[pair.b] += spring * targets_[pair.a * 3 + c];
    }
    kernels_.cholesky_solve(factor_.data(), count, stride, column_.data());
    for (size_t p = 0; p < count; ++p)
      x_[p * 3 + c] = moves(p) ? column_[p] : targets_[p * 3 + c];
  }
  double value = 0;
  for (size_t p = 0; p < count * 3; ++p) {
    const double moved = x_[p] - targets_[p];
    if (moves(p / 3)) value += 0.5 * weights_[p / 3] * moved * moved;
  }
  for (Pair& pair : pairs_) {
    double squared = 0;
    for (size_t c = 0; c < 3; ++c) {
      pair.apart[c] = x_[pair.a * 3 + c] - x_[pair.b * 3 + c];
      squared += pair.apart[c] * pair.apart[c];
    }
    pair.length = std::sqrt(squared);
    value += 0.5 * (trial ? pair.trial : pair.multiplier) * (squared - pair.limit * pair.limit);
  }
  return value;
}

// The pairs that pull, and of those that exceed their limit the worst for which there is room.
bool StretchLimit::ChooseActive() {
  active_.clear();
  const auto can_move = [this](const Pair& pair) {
    return std::isfinite(weights_[pair.a]) || std::isfinite(weights_[pair.b]);
  };
  for (size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    if (pair.multiplier > 0 || (pair.length > pair.limit && can_move(pair))) active_.push_back(i);
  }
  if (active_.size() > max_active_) {
    std::sort(active_.begin(), active_.end(), [this](size_t i, size_t j) {
      const Pair &a = pairs_[i], &b = pairs_[j];
      if ((a.multiplier > 0) != (b.multiplier > 0)) return a.multiplier > 0;
      const double excess = a.length * b.limit - b.length * a.limit;
      return excess != 0 ? excess > 0 : i < j;
    });
    active_.resize(max_active_);
  }
  return !active_.empty();
}

// No limit is exceeded, and who pulls is at its limit.
bool StretchLimit::IsSolved() const {
  for (const size_t i : active_) {
    const Pair& pair = pairs_[i];
    const double excess = pair.length / pair.limit - 1;
    if (excess > kTolerance || (pair.multiplier > 0 && excess < -kTolerance)) return false;
  }
  return true;
}

// Of the dual over the active pairs, H_ij = (x_i . x_j) (e_i^T A^-1 e_j).
void StretchLimit::NewtonStep(size_t dimension, bool reciprocal) {
  const size_t count = active_.size(), stride = PaddedSize(count);
  std::fill_n(hessian_.begin(), stride * stride, 0.0);
  std::fill_n(step_.begin(), stride, 0.0);
  const auto inverse = [this](size_t row, size_t column) {
    const bool moves = std::isfinite(weights_[row]) && std::isfinite(weights_[column]);
    return moves ? inverse_[column * stride_ + row] : 0;
  };
  double trace = 0;
  for (size_t i = 0; i < count; ++i) {
    const Pair& p = pairs_[active_[i]];
    for (size_t j = i; j < count; ++j) {
      const Pair& q = pairs_[active_[j]];
      double along = 0;
      for (size_t c = 0; c < dimension; ++c)
        along += p.apart[c] * q.apart[c];
      hessian_[i * stride + j] =
          along * (inverse(p.a, q.a) - inverse(p.a, q.b) - inverse(p.b, q.a) + inverse(p.b, q.b));
    }
    trace += hessian_[i * stride + i];
    const double squared = p.length * p.length;
    step_[i] =
        reciprocal ? squared * (p.length / p.limit - 1) : 0.5 * (squared - p.limit * p.limit);
  }
  for (size_t i = 0; i < count; ++i) {
    hessian_[i * stride + i] += kRegularisation * trace / static_cast<double>(count);
    for (size_t j = i + 1; j < count; ++j)
      hessian_[j * stride + i] = hessian_[i * stride + j];
  }
  StepWithinBounds(count, stride);
}

// max slope . d - 1/2 d^T H d so that no multiplier becomes negative, coordinate by coordinate; d
// is left in step_. Stopped early it still is a way up.
void StretchLimit::StepWithinBounds(size_t count, size_t stride) {
  slope_ = step_;
  std::fill_n(step_.begin(), stride, 0.0);
  double first = 0;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double gained = 0;
    for (size_t i = 0; i < count; ++i) {
      const double* row = hessian_.data() + i * stride;
      const double least = -pairs_[active_[i]].multiplier;
      const double change = std::max(least, step_[i] + slope_[i] / row[i]) - step_[i];
      if (change == 0) continue;
      step_[i] += change;
      gained += change * change * row[i];
      kernels_.add_scaled(-change, row, stride / kBlockLanes, slope_.data());
    }
    if (sweep == 0) first = gained;
    if (!(gained > 1e-20 * first)) break;
  }
}

// Along the step, kept non-negative, as far as the dual rises.
bool StretchLimit::Ascend(const Problem& problem, double* value) {
  double length = 1;
  for (int halving = 0; halving < kMaxHalvings; ++halving, length /= 2) {
    for (Pair& pair : pairs_)
      pair.trial = pair.multiplier;
    for (size_t i = 0; i < active_.size(); ++i) {
      Pair& pair = pairs_[active_[i]];
      pair.trial = std::max(0.0, pair.multiplier + length * step_[i]);
    }
    const double reached = Place(problem, true);
    if (!(reached > *value)) continue;
    *value = reached;
    for (Pair& pair : pairs_)
      pair.multiplier = pair.trial;
    return true;
  }
  (void)Place(problem, false);
  return false;
}

StretchLimit::Outcome StretchLimit::Project(const Problem& problem, double* points) {
  Outcome outcome;
  CollectPairs(problem, points);
  double value = Place(problem, false);
  const size_t count = problem.handles.size(), stride = PaddedSize(count);
  while (ChooseActive() && !IsSolved() && outcome.iterations < kMaxIterations) {
    ++outcome.iterations;
    for (size_t p = 0; p < count; ++p) {
      std::fill_n(column_.begin(), stride, 0.0);
      column_[p] = 1;
      kernels_.cholesky_solve(factor_.data(), count, stride, column_.data());
      std::copy_n(column_.begin(), count, inverse_.begin() + static_cast<ptrdiff_t>(p * stride_));
    }
    NewtonStep(problem.dimension, true);
    if (Ascend(problem, &value)) continue;
    NewtonStep(problem.dimension, false);
    if (!Ascend(problem, &value)) break;
  }
  for (const Pair& pair : pairs_) {
    outcome.violation = std::max(outcome.violation, pair.length / pair.limit - 1);
    outcome.pairs_at_limit += pair.multiplier > 0 ? 1 : 0;
  }
  outcome.is_feasible = outcome.violation <= 10 * kTolerance;
  if (outcome.iterations == 0) return outcome;
  for (size_t p = 0; p < count; ++p)
    std::copy_n(x_.begin() + static_cast<ptrdiff_t>(p * 3), problem.dimension,
                points + p * problem.dimension);
  return outcome;
}

}  // namespace limber
