#include "solve/blend_weight_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber {
namespace {

// Multipliers this small, of the largest gradient, are rounding where f is nearly zero.
constexpr double kMultiplierTolerance = 1e-8;

// Room for this many weights in use a group, and for all of them in small characters: a few shapes
// mix in a group, whatever their number.
constexpr int kUsedPerGroup = 6, kUsedAlways = 512;

size_t Padded(int count) {
  return PaddedSize(static_cast<size_t>(count));
}

}  // namespace

BlendWeightStep::BlendWeightStep(const SolveKernels& kernels, int num_groups, int num_shapes,
                                 int max_rows)
    : kernels_(kernels),
      num_groups_(num_groups),
      num_shapes_(num_shapes),
      num_blocks_(num_groups * num_shapes),
      max_used_(std::min(num_blocks_, std::max(kUsedAlways, kUsedPerGroup * num_groups))),
      row_stride_(Padded(max_rows)),
      used_stride_(Padded(max_used_)),
      slot_(static_cast<size_t>(num_blocks_), -1),
      loads_(static_cast<size_t>(max_used_) * row_stride_),
      quadratic_(static_cast<size_t>(max_used_) * used_stride_),
      is_free_(static_cast<size_t>(num_blocks_)),
      reference_(static_cast<size_t>(num_groups)),
      nearness_(static_cast<size_t>(num_blocks_)),
      is_exact_(static_cast<size_t>(num_blocks_)),
      gradient_(Padded(num_blocks_)),
      errors_(gradient_),
      residual_(row_stride_),
      load_(row_stride_),
      start_(static_cast<size_t>(num_blocks_)),
      weights_(used_stride_),
      used_gradient_(used_stride_),
      slot_changes_(used_stride_),
      newton_(used_stride_),
      slope_(used_stride_),
      direction_(used_stride_) {
  used_.reserve(static_cast<size_t>(max_used_));
  free_.reserve(static_cast<size_t>(max_used_));
  const size_t most_free = Padded(std::max(0, max_used_ - num_groups));
  hessian_.resize(most_free * most_free);
  trades_.resize(most_free * row_stride_);
}

void BlendWeightStep::Forget() {
  for (const int block : used_)
    slot_[static_cast<size_t>(block)] = -1;
  used_.clear();
}

// Where room is short: forgets weights that are zero and stay so, unless none is.
void BlendWeightStep::DropUnused(const double* blend) {
  size_t kept = 0;
  for (size_t slot = 0; slot < used_.size(); ++slot) {
    const auto block = static_cast<size_t>(used_[slot]);
    if (blend[block] == 0 && is_free_[block] == 0) {
      slot_[block] = -1;
      continue;
    }
    // Rows move up, then columns: whatever moves comes from a later place than where it goes.
    std::copy_n(loads_.data() + slot * row_stride_, row_stride_,
                loads_.data() + kept * row_stride_);
    std::copy_n(quadratic_.data() + slot * used_stride_, used_stride_,
                quadratic_.data() + kept * used_stride_);
    for (size_t row = 0; row < used_.size(); ++row)
      quadratic_[row * used_stride_ + kept] = quadratic_[row * used_stride_ + slot];
    weights_[kept] = blend[block];
    slot_[block] = static_cast<int>(kept);
    used_[kept++] = static_cast<int>(block);
  }
  used_.resize(kept);
}

// Gives a weight a slot; false where there is no room left.
bool BlendWeightStep::Use(const BlendProblem& problem, int block, const double* blend) {
  Nearness(problem, block);
  if (slot_[static_cast<size_t>(block)] >= 0) return true;
  if (static_cast<int>(used_.size()) == max_used_) DropUnused(blend);
  if (static_cast<int>(used_.size()) == max_used_) return false;
  const size_t slot = used_.size();
  used_.push_back(block);
  slot_[static_cast<size_t>(block)] = static_cast<int>(slot);
  weights_[slot] = blend[block];
  double* entries = quadratic_.data() + slot * used_stride_;
  problem.form->Entries(block, used_.data(), used_.size(), entries);
  for (size_t other = 0; other < slot; ++other)
    quadratic_[other * used_stride_ + slot] = entries[other];
  double* load = loads_.data() + slot * row_stride_;
  problem.form->Load(block, load);
  std::fill(load + problem.num_rows, load + row_stride_, 0.0);
  return true;
}

// A group's reference is its largest weight: it is the last one that a step drives to its bound.
void BlendWeightStep::CollectFree(const double* blend) {
  free_.clear();
  for (int g = 0; g < num_groups_; ++g) {
    int reference = g * num_shapes_;
    for (int j = reference; j < (g + 1) * num_shapes_; ++j) {
      if (blend[j] > blend[reference]) reference = j;
    }
    reference_[static_cast<size_t>(g)] = reference;
    is_free_[static_cast<size_t>(reference)] = 1;
    for (int j = g * num_shapes_; j < (g + 1) * num_shapes_; ++j) {
      if (is_free_[static_cast<size_t>(j)] != 0 && j != reference) free_.push_back(j);
    }
  }
}

// A B - a, f(B) and the gradient, the latter at the weights in use only.
void BlendWeightStep::UpdateUsedGradient(const BlendProblem& problem, const double* blend) {
  const size_t count = used_.size(), chunks = NumChunks(count);
  std::fill_n(weights_.begin(), chunks * kBlockLanes, 0.0);
  for (size_t slot = 0; slot < count; ++slot)
    weights_[slot] = blend[used_[slot]];
  for (int row = 0; row < problem.num_rows; ++row)
    residual_[static_cast<size_t>(row)] = -problem.goal[row];
  std::fill(residual_.begin() + problem.num_rows,
            residual_.begin() + static_cast<ptrdiff_t>(row_stride_), 0.0);
  const size_t row_chunks = row_stride_ / kBlockLanes;
  kernels_.add_rows(loads_.data(), row_stride_, weights_.data(), count, row_chunks,
                    residual_.data());
  value_ = 0.5 * kernels_.dot(residual_.data(), residual_.data(), row_chunks);
  std::fill_n(used_gradient_.begin(), chunks * kBlockLanes, 0.0);
  kernels_.add_rows(quadratic_.data(), used_stride_, weights_.data(), count, chunks,
                    used_gradient_.data());
  value_ += 0.5 * kernels_.dot(weights_.data(), used_gradient_.data(), chunks);
  kernels_.dot_rows(loads_.data(), row_stride_, count, residual_.data(), row_chunks,
                    slot_changes_.data());
  for (size_t slot = 0; slot < count; ++slot) {
    const auto block = static_cast<size_t>(used_[slot]);
    const double moved = blend[block] - start_[block];
    value_ += 0.5 * problem.proximal * moved * moved;
    used_gradient_[slot] += slot_changes_[slot] + problem.proximal * moved;
    gradient_[block] = used_gradient_[slot];
  }
  value_ = std::max(value_, 0.0);
}

// After UpdateUsedGradient: at all weights.
void BlendWeightStep::UpdateFullGradient(const BlendProblem& problem, const double* blend) {
  problem.form->Gradient(blend, residual_.data(), gradient_.data(), errors_.data());
  for (size_t slot = 0; slot < used_.size(); ++slot) {
    const auto block = static_cast<size_t>(used_[slot]);
    gradient_[block] = used_gradient_[slot];
    errors_[block] = 0;
  }
}

// The gradient at a weight that has no slot, and so was zero at the start.
void BlendWeightStep::PriceExactly(const BlendProblem& problem, int block) {
  const auto i = static_cast<size_t>(block);
  const size_t rows = row_stride_ / kBlockLanes, chunks = NumChunks(used_.size());
  problem.form->Entries(block, used_.data(), used_.size(), slot_changes_.data());
  std::fill(slot_changes_.begin() + static_cast<ptrdiff_t>(used_.size()),
            slot_changes_.begin() + static_cast<ptrdiff_t>(chunks * kBlockLanes), 0.0);
  problem.form->Load(block, load_.data());
  std::fill(load_.begin() + problem.num_rows, load_.end(), 0.0);
  gradient_[i] = kernels_.dot(slot_changes_.data(), weights_.data(), chunks) +
                 kernels_.dot(load_.data(), residual_.data(), rows);
  errors_[i] = 0;
}

// Of f, in the coordinates of free_ (each trades with its group's reference), lower triangle.
void BlendWeightStep::BuildHessian(const BlendProblem& problem) {
  const size_t size = free_.size(), stride = PaddedSize(size), rows = row_stride_ / kBlockLanes;
  const auto slot = [this](int block) {
    return static_cast<size_t>(slot_[static_cast<size_t>(block)]);
  };
  const auto reference = [this](int block) {
    return reference_[static_cast<size_t>(block / num_shapes_)];
  };
  for (size_t a = 0; a < size; ++a) {
    double* trade = trades_.data() + a * row_stride_;
    std::copy_n(loads_.data() + slot(free_[a]) * row_stride_, row_stride_, trade);
    kernels_.add_scaled(-1, loads_.data() + slot(reference(free_[a])) * row_stride_, rows, trade);
  }
  for (size_t a = 0; a < size; ++a) {
    const double* trade = trades_.data() + a * row_stride_;
    double* column = hessian_.data() + a * stride;
    kernels_.dot_rows(trade, row_stride_, size - a, trade, rows, column + a);
    std::copy_n(quadratic_.data() + slot(free_[a]) * used_stride_, used_stride_,
                slot_changes_.data());
    kernels_.add_scaled(-1, quadratic_.data() + slot(reference(free_[a])) * used_stride_,
                        NumChunks(used_.size()), slot_changes_.data());
    for (size_t b = a; b < size; ++b) {
      column[b] += slot_changes_[slot(free_[b])] - slot_changes_[slot(reference(free_[b]))];
      if (reference(free_[b]) == reference(free_[a])) column[b] += problem.proximal;
    }
    column[a] += problem.proximal;
    std::fill(column + size, column + stride, 0.0);
  }
}

// On the affine hull of the free weights: with u the reduced Newton step of f and d the answer to
// the nearness term, the minimiser lies at u + tau d, tau^2 = 4 (f(u) + delta^2) / (1 - 2 m^2),
// m^2 = d^T H d; it is left in newton_. False: 2 m^2 >= 1, the linear term wins and d, left in
// direction_, is to be followed to the border. Without the square root tau = 1.
bool BlendWeightStep::MinimiserOnFace(const BlendProblem& problem) {
  const size_t size = free_.size(), stride = PaddedSize(size), chunks = stride / kBlockLanes;
  BuildHessian(problem);
  kernels_.cholesky_factor(hessian_.data(), size, stride);
  for (AlignedVector<double>* side : {&newton_, &slope_, &direction_})
    std::fill_n(side->begin(), stride, 0.0);
  for (size_t a = 0; a < size; ++a) {
    const auto block = static_cast<size_t>(free_[a]);
    const auto reference =
        static_cast<size_t>(reference_[static_cast<size_t>(free_[a] / num_shapes_)]);
    newton_[a] = slope_[a] = gradient_[reference] - gradient_[block];
    direction_[a] = nearness_[reference] - nearness_[block];
  }
  kernels_.cholesky_solve(hessian_.data(), size, stride, newton_.data());
  const double reached =
      std::max(value_ - 0.5 * kernels_.dot(slope_.data(), newton_.data(), chunks), 0.0) +
      problem.delta_squared;
  std::copy_n(direction_.begin(), stride, slope_.begin());
  kernels_.cholesky_solve(hessian_.data(), size, stride, direction_.data());
  double tau = 1;
  if (problem.square_root) {
    const double m_squared = kernels_.dot(slope_.data(), direction_.data(), chunks);
    if (2 * m_squared >= 1) return false;
    tau = 2 * std::sqrt(reached / (1 - 2 * m_squared));
  }
  kernels_.add_scaled(tau, direction_.data(), chunks, newton_.data());
  return true;
}

// Goes along the step as far as all weights stay non-negative. True: the step's end was reached.
bool BlendWeightStep::MoveTowards(bool bounded, double* blend) {
  const size_t size = free_.size();
  const AlignedVector<double>& move = bounded ? newton_ : direction_;
  double length = bounded ? 1.0 : std::numeric_limits<double>::infinity();
  int blocking = -1;
  const auto limit = [&](int j, double rate) {
    if (rate < 0 && blend[j] < -rate * length) {
      length = blend[j] / -rate;
      blocking = j;
    }
  };
  size_t a = 0;
  for (int g = 0; g < num_groups_; ++g) {
    double reference_rate = 0;
    for (; a < size && free_[a] / num_shapes_ == g; ++a) {
      limit(free_[a], move[a]);
      reference_rate -= move[a];
    }
    limit(reference_[static_cast<size_t>(g)], reference_rate);
  }
  if (!std::isfinite(length)) return true;  // nothing moves: all rates are zero
  for (size_t b = 0; b < size; ++b) {
    blend[free_[b]] += length * move[b];
    blend[reference_[static_cast<size_t>(free_[b] / num_shapes_)]] -= length * move[b];
  }
  if (blocking < 0) return true;
  blend[blocking] = 0;
  is_free_[static_cast<size_t>(blocking)] = 0;
  return false;
}

// The linear term of one weight, exactly.
double BlendWeightStep::Nearness(const BlendProblem& problem, int block) {
  const auto i = static_cast<size_t>(block);
  if (is_exact_[i] == 0) {
    if (problem.nearness_term != nullptr) nearness_[i] = problem.nearness_term->Exact(block);
    is_exact_[i] = 1;
  }
  return nearness_[i];
}

// Without evaluating more than the answer needs.
bool BlendWeightStep::IsNearnessAtLeast(const BlendProblem& problem, int block, double level) {
  const auto i = static_cast<size_t>(block);
  if (nearness_[i] >= level) return true;
  if (is_exact_[i] != 0 || problem.nearness_term == nullptr) return false;
  const NearnessTerm::Bound bound = problem.nearness_term->Raise(block, level);
  nearness_[i] = bound.value;
  is_exact_[i] = bound.is_exact ? 1 : 0;
  return nearness_[i] >= level || Nearness(problem, block) >= level;
}

// The most negative multiplier of a group's weights at their bound, and in *block whose it is; none
// (-1) where all are above -tolerance. A lower bound that is good enough is not looked behind.
double BlendWeightStep::WorstOfGroup(const BlendProblem& problem, const double* blend, int group,
                                     double outer, double tolerance, int* block) {
  const auto steepness = [&](int j) { return outer * gradient_[static_cast<size_t>(j)]; };
  const int reference = reference_[static_cast<size_t>(group)];
  const double level = steepness(reference) + nearness_[static_cast<size_t>(reference)];
  double worst = -tolerance;
  *block = -1;
  for (int j = group * num_shapes_; j < (group + 1) * num_shapes_; ++j) {
    if (is_free_[static_cast<size_t>(j)] != 0 || blend[j] != 0) continue;
    const double error = outer * errors_[static_cast<size_t>(j)];
    if (IsNearnessAtLeast(problem, j, worst + level - steepness(j) + error)) continue;
    if (error > 0) {
      PriceExactly(problem, j);
      if (IsNearnessAtLeast(problem, j, worst + level - steepness(j))) continue;
    }
    worst = steepness(j) + Nearness(problem, j) - level;
    *block = j;
  }
  return worst;
}

// Frees the weights at their bound whose multiplier is negative, the worst of each group or of all;
// sets report's violation to the largest. False: none was freed.
bool BlendWeightStep::ReleaseBound(const BlendProblem& problem, const double* blend, bool one_only,
                                   BlendReport* report) {
  const double outer = problem.square_root ? 0.5 / std::sqrt(value_ + problem.delta_squared) : 1.0;
  double scale = 0;
  for (const int block : used_) {
    const auto i = static_cast<size_t>(block);
    scale = std::max(scale, std::abs(outer * gradient_[i] + nearness_[i]));
  }
  bool freed = false;
  double worst = 0;
  int worst_block = -1;
  const auto release = [&](int block) {
    if (block < 0 || !Use(problem, block, blend)) return;
    is_free_[static_cast<size_t>(block)] = 1;
    freed = true;
  };
  for (int g = 0; g < num_groups_; ++g) {
    int block = -1;
    const double group_worst =
        WorstOfGroup(problem, blend, g, outer, kMultiplierTolerance * scale, &block);
    if (block >= 0 && group_worst < worst) {
      worst = group_worst;
      worst_block = block;
    }
    if (!one_only) release(block);
  }
  if (one_only) release(worst_block);
  report->violation = worst < 0 ? -worst / scale : 0;
  return freed;
}

// Nothing to gain: f is rounding, and all weights in use are on the nearest examples.
bool BlendWeightStep::StartIsMatched(const BlendProblem& problem, const double* blend) {
  if (value_ > problem.matched) return false;
  for (int g = 0; g < num_groups_; ++g) {
    double farthest_used = 0;
    for (int j = g * num_shapes_; j < (g + 1) * num_shapes_; ++j) {
      if (blend[j] > 0) farthest_used = std::max(farthest_used, Nearness(problem, j));
    }
    for (int j = g * num_shapes_; j < (g + 1) * num_shapes_; ++j) {
      if (!IsNearnessAtLeast(problem, j, farthest_used)) return false;
    }
  }
  return true;
}

double BlendWeightStep::Objective(const BlendProblem& problem, const double* blend) const {
  double objective = problem.square_root ? std::sqrt(value_ + problem.delta_squared) : value_;
  for (const int block : used_)
    objective += nearness_[static_cast<size_t>(block)] * blend[block];
  return objective;
}

BlendReport BlendWeightStep::Solve(const BlendProblem& problem, double* blend) {
  const int most_faces = 50 + 8 * num_blocks_;
  BlendReport report;
  if (Padded(problem.num_rows) != row_stride_) {
    Forget();
    row_stride_ = Padded(problem.num_rows);
  }
  for (int j = 0; j < num_blocks_; ++j) {
    is_free_[static_cast<size_t>(j)] = blend[j] > 0 ? 1 : 0;
    start_[static_cast<size_t>(j)] = blend[j];
    nearness_[static_cast<size_t>(j)] = problem.nearness[j];
    is_exact_[static_cast<size_t>(j)] = 0;
  }
  for (int j = 0; j < num_blocks_; ++j) {
    if (blend[j] > 0 && !Use(problem, j, blend)) return report;
  }
  UpdateUsedGradient(problem, blend);
  if (StartIsMatched(problem, blend)) {
    report.converged = true;
    return report;
  }
  double last_objective = std::numeric_limits<double>::infinity();
  for (report.faces = 1; report.faces <= most_faces; ++report.faces) {
    CollectFree(blend);
    if (!free_.empty()) {
      const bool reached = MoveTowards(MinimiserOnFace(problem), blend);
      UpdateUsedGradient(problem, blend);
      if (!reached) continue;
    }
    UpdateFullGradient(problem, blend);
    // Freeing one weight in every group at once is quick; where that gained nothing (degenerate
    // corners), one at a time always does.
    const double objective = Objective(problem, blend);
    const bool gained = objective < last_objective * (1 - 1e-14);
    last_objective = objective;
    if (!ReleaseBound(problem, blend, !gained, &report)) {
      report.converged = report.violation == 0;  // else there is no room for another weight
      break;
    }
  }
  report.used = static_cast<int>(used_.size());
  return report;
}

}  // namespace limber
