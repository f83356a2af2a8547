#include "solve/convex_step.h"

#include <algorithm>
#include <numeric>

namespace limber {

// Q, S x S, and A, rows x S, from those of all blocks.
class ConvexStep::UniformForm final : public BlendForm {
 public:
  UniformForm(const BlendProblem& varying, ConvexStep* owner) : varying_(varying), owner_(*owner) {}

  void Entries(int shape, const int* others, size_t count, double* entries) override {
    const size_t groups = owner_.blocks_.size();
    for (size_t i = 0; i < count; ++i) {
      for (size_t g = 0; g < groups; ++g)
        owner_.blocks_[g] = Block(g, others[i]);
      entries[i] = 0;
      for (size_t g = 0; g < groups; ++g) {
        varying_.form->Entries(Block(g, shape), owner_.blocks_.data(), groups,
                               owner_.entries_.data());
        entries[i] += std::accumulate(owner_.entries_.begin(), owner_.entries_.end(), 0.0);
      }
    }
  }

  void Load(int shape, double* load) override {
    const auto rows = static_cast<size_t>(varying_.num_rows);
    std::fill_n(load, rows, 0.0);
    for (size_t g = 0; g < owner_.blocks_.size(); ++g) {
      varying_.form->Load(Block(g, shape), owner_.load_.data());
      for (size_t row = 0; row < rows; ++row)
        load[row] += owner_.load_[row];
    }
  }

  void Gradient(const double* blend, const double* residual, double* gradient,
                double* errors) override {
    const auto shapes = static_cast<size_t>(owner_.num_shapes_);
    const size_t blocks = owner_.blocks_.size() * shapes;
    for (size_t i = 0; i < blocks; ++i)
      owner_.spread_[i] = blend[i % shapes];
    varying_.form->Gradient(owner_.spread_.data(), residual, owner_.gradient_.data(),
                            owner_.errors_.data());
    std::fill_n(gradient, shapes, 0.0);
    std::fill_n(errors, shapes, 0.0);
    for (size_t i = 0; i < blocks; ++i) {
      gradient[i % shapes] += owner_.gradient_[i];
      errors[i % shapes] += owner_.errors_[i];
    }
  }

 private:
  int Block(size_t group, int shape) const {
    return static_cast<int>(group) * owner_.num_shapes_ + shape;
  }

  const BlendProblem& varying_;
  ConvexStep& owner_;
};

ConvexStep::ConvexStep(const SolveKernels& kernels, int num_groups, int num_shapes, int max_rows)
    : num_groups_(num_groups),
      num_shapes_(num_shapes),
      varying_(kernels, num_groups, num_shapes, max_rows),
      uniform_(kernels, 1, num_shapes, max_rows),
      blend_(static_cast<size_t>(num_shapes)),
      nearness_(blend_),
      spread_(PaddedSize(static_cast<size_t>(num_groups) * static_cast<size_t>(num_shapes))),
      gradient_(spread_),
      errors_(spread_),
      entries_(static_cast<size_t>(num_groups)),
      load_(static_cast<size_t>(max_rows)),
      blocks_(static_cast<size_t>(num_groups)) {}

void ConvexStep::Forget() {
  varying_.Forget();
  uniform_.Forget();
}

BlendReport ConvexStep::Solve(const BlendProblem& problem, bool varies, double* blend) {
  return varies ? varying_.Solve(problem, blend) : SolveUniform(problem, blend);
}

BlendReport ConvexStep::SolveUniform(const BlendProblem& varying, double* blend) {
  const auto shapes = static_cast<size_t>(num_shapes_);
  const size_t blocks = shapes * static_cast<size_t>(num_groups_);
  std::copy_n(blend, shapes, blend_.begin());
  std::fill(nearness_.begin(), nearness_.end(), 0.0);
  for (size_t i = 0; i < blocks; ++i) {
    blend_[i % shapes] += (blend[i] - blend[i % shapes]) / num_groups_;  // nothing where equal
    nearness_[i % shapes] += varying.nearness_term != nullptr
                                 ? varying.nearness_term->Exact(static_cast<int>(i))
                                 : varying.nearness[i];
  }
  UniformForm form(varying, this);
  BlendProblem problem = varying;
  problem.form = &form;
  problem.nearness = nearness_.data();
  problem.nearness_term = nullptr;  // exact already
  problem.proximal *= num_groups_;
  const BlendReport report = uniform_.Solve(problem, blend_.data());
  for (size_t i = 0; i < blocks; ++i)
    blend[i] = blend_[i % shapes];
  return report;
}

}  // namespace limber
