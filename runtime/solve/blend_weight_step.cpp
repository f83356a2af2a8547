#include "solve/blend_weight_step.h"

#include "solve/dense_cholesky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace limber {
namespace {

// Multipliers this small, of the largest gradient, are rounding where f is nearly zero.
constexpr double kMultiplierTolerance = 1e-8;

}  // namespace

// A step in the coordinates of free_; `unbounded`: along `direction` until a bound stops it.
struct BlendWeightStep::Step {
  bool unbounded = false;
};

BlendWeightStep::BlendWeightStep(int num_groups, int num_shapes)
    : num_groups_(num_groups),
      num_shapes_(num_shapes) {
  const auto blocks = static_cast<size_t>(num_groups) * static_cast<size_t>(num_shapes);
  const size_t most_free = blocks - static_cast<size_t>(num_groups);
  is_free_.resize(blocks);
  gradient_.resize(blocks);
  start_.resize(blocks);
  free_.reserve(blocks);
  reference_.resize(static_cast<size_t>(num_groups));
  hessian_.resize(most_free * most_free);
  newton_.resize(most_free);
  slope_.resize(most_free);
  direction_.resize(most_free);
}

// A group's reference is its largest weight: it is the last one that a step drives to its bound.
void BlendWeightStep::CollectFree(const double* blend) {
  free_.clear();
  for (int g = 0; g < num_groups_; ++g) {
    int reference = g * num_shapes_;
    for (int j = reference; j < (g + 1) * num_shapes_; ++j) {
      if (blend[j] > blend[reference]) reference = j;
    }
    reference_[g] = reference;
    is_free_[reference] = 1;
    for (int j = g * num_shapes_; j < (g + 1) * num_shapes_; ++j) {
      if (is_free_[j] != 0 && j != reference) free_.push_back(j);
    }
  }
}

void BlendWeightStep::UpdateGradient(const BlendProblem& problem, const double* blend) {
  const int blocks = num_groups_ * num_shapes_;
  for (int i = 0; i < blocks; ++i)
    gradient_[i] = 0;
  for (int j = 0; j < blocks; ++j) {
    if (blend[j] == 0) continue;
    const double* column = problem.quadratic->Column(j);
    for (int i = 0; i < blocks; ++i)
      gradient_[i] += blend[j] * column[i];
  }
  double value = problem.constant;  // 1/2 B.(Q B - 2 l) + c0
  for (int i = 0; i < blocks; ++i) {
    value += blend[i] * (0.5 * gradient_[i] - problem.linear[i]);
    const double moved = blend[i] - start_[i];
    value += 0.5 * problem.proximal * moved * moved;
    gradient_[i] += problem.proximal * moved - problem.linear[i];
  }
  value_ = std::max(value, 0.0);
}

// On the affine hull of the free weights: with u the reduced Newton step of f and d the answer to
// the nearness term, the minimiser lies at u + tau d, tau^2 = 4 (f(u) + delta^2) / (1 - 2 m^2),
// m^2 = d^T Q d; where 2 m^2 >= 1 the linear term wins and d is followed to the border.
BlendWeightStep::Step BlendWeightStep::MinimiserOnFace(const BlendProblem& problem) {
  const int size = static_cast<int>(free_.size());
  for (int a = 0; a < size; ++a) {
    const int ref_a = reference_[free_[a] / num_shapes_];
    const double* column = problem.quadratic->Column(free_[a]);
    const double* ref_column = problem.quadratic->Column(ref_a);
    for (int b = a; b < size; ++b) {
      const int ref_b = reference_[free_[b] / num_shapes_];
      hessian_[b * size + a] =
          column[free_[b]] - column[ref_b] - ref_column[free_[b]] + ref_column[ref_b];
      if (ref_a == ref_b) hessian_[b * size + a] += problem.proximal;
    }
    hessian_[a * size + a] += problem.proximal;
    newton_[a] = gradient_[ref_a] - gradient_[free_[a]];
    slope_[a] = problem.nearness[free_[a]] - problem.nearness[ref_a];
    direction_[a] = -slope_[a];
  }
  CholeskyFactor(hessian_.data(), size);
  double reached = value_;
  for (int a = 0; a < size; ++a)
    slope_[a] = -newton_[a];  // reduced gradient of f, kept for f(u)
  CholeskySolve(hessian_.data(), size, newton_.data());
  for (int a = 0; a < size; ++a)
    reached += 0.5 * slope_[a] * newton_[a];
  reached = std::max(reached, 0.0) + problem.delta_squared;
  for (int a = 0; a < size; ++a)
    slope_[a] = -direction_[a];
  CholeskySolve(hessian_.data(), size, direction_.data());
  double m_squared = 0;
  for (int a = 0; a < size; ++a)
    m_squared -= slope_[a] * direction_[a];
  if (2 * m_squared >= 1) return Step{true};
  const double tau = 2 * std::sqrt(reached / (1 - 2 * m_squared));
  for (int a = 0; a < size; ++a)
    newton_[a] += tau * direction_[a];
  return Step{false};
}

// Goes along the step as far as all weights stay non-negative. True: the step's end was reached.
bool BlendWeightStep::MoveTowards(const Step& step, double* blend) {
  const int size = static_cast<int>(free_.size());
  const std::vector<double>& move = step.unbounded ? direction_ : newton_;
  double length = step.unbounded ? std::numeric_limits<double>::infinity() : 1.0;
  int blocking = -1;
  const auto limit = [&](int j, double rate) {
    if (rate < 0 && blend[j] < -rate * length) {
      length = blend[j] / -rate;
      blocking = j;
    }
  };
  int a = 0;
  for (int g = 0; g < num_groups_; ++g) {
    double reference_rate = 0;
    for (; a < size && free_[a] / num_shapes_ == g; ++a) {
      limit(free_[a], move[a]);
      reference_rate -= move[a];
    }
    limit(reference_[g], reference_rate);
  }
  if (!std::isfinite(length)) return true;  // nothing moves: all rates are zero
  for (int b = 0; b < size; ++b) {
    blend[free_[b]] += length * move[b];
    blend[reference_[free_[b] / num_shapes_]] -= length * move[b];
  }
  if (blocking < 0) return true;
  blend[blocking] = 0;
  is_free_[blocking] = 0;
  return false;
}

// Frees the weights at their bound whose multiplier is negative; returns the largest violation.
double BlendWeightStep::ReleaseBound(const BlendProblem& problem, const double* blend,
                                     bool one_only) {
  const double half = 0.5 / std::sqrt(value_ + problem.delta_squared);
  const auto slope = [&](int j) { return half * gradient_[j] + problem.nearness[j]; };
  double scale = 0;
  for (int j = 0; j < num_groups_ * num_shapes_; ++j)
    scale = std::max(scale, std::abs(slope(j)));
  double worst = 0;
  int worst_block = -1;
  for (int g = 0; g < num_groups_; ++g) {
    const double level = slope(reference_[g]);
    double group_worst = -kMultiplierTolerance * scale;
    int group_block = -1;
    for (int j = g * num_shapes_; j < (g + 1) * num_shapes_; ++j) {
      if (is_free_[j] == 0 && blend[j] == 0 && slope(j) - level < group_worst) {
        group_worst = slope(j) - level;
        group_block = j;
      }
    }
    if (group_block < 0) continue;
    if (!one_only) is_free_[group_block] = 1;
    if (group_worst < worst) {
      worst = group_worst;
      worst_block = group_block;
    }
  }
  if (one_only && worst_block >= 0) is_free_[worst_block] = 1;
  return worst < 0 ? -worst / scale : 0;
}

// Nothing to gain: f is rounding, and all weights in use are on the nearest examples.
bool BlendWeightStep::StartIsMatched(const BlendProblem& problem, const double* blend) const {
  if (value_ > problem.matched) return false;
  for (int g = 0; g < num_groups_; ++g) {
    const double* nearness = problem.nearness + std::ptrdiff_t{g} * num_shapes_;
    const double nearest = *std::min_element(nearness, nearness + num_shapes_);
    for (int s = 0; s < num_shapes_; ++s) {
      if (blend[g * num_shapes_ + s] > 0 && nearness[s] > nearest) return false;
    }
  }
  return true;
}

BlendReport BlendWeightStep::Solve(const BlendProblem& problem, double* blend) {
  const int blocks = num_groups_ * num_shapes_;
  const int most_faces = 50 + 8 * blocks;
  for (int j = 0; j < blocks; ++j) {
    is_free_[j] = blend[j] > 0 ? 1 : 0;
    start_[j] = blend[j];
  }
  BlendReport report;
  UpdateGradient(problem, blend);
  if (StartIsMatched(problem, blend)) {
    report.converged = true;
    return report;
  }
  double last_value = std::numeric_limits<double>::infinity();
  for (report.faces = 1; report.faces <= most_faces; ++report.faces) {
    CollectFree(blend);
    UpdateGradient(problem, blend);
    if (!free_.empty() && !MoveTowards(MinimiserOnFace(problem), blend)) continue;
    UpdateGradient(problem, blend);
    // Freeing one weight in every group at once is quick; where that gained nothing (degenerate
    // corners), one at a time always does.
    double objective = std::sqrt(value_ + problem.delta_squared);
    for (int j = 0; j < blocks; ++j)
      objective += problem.nearness[j] * blend[j];
    const bool gained = objective < last_value * (1 - 1e-14);
    last_value = objective;
    report.violation = ReleaseBound(problem, blend, !gained);
    if (report.violation == 0) {
      report.converged = true;
      break;
    }
  }
  return report;
}

}  // namespace limber
