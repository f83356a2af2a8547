// The convex step's quadratic form from matrices.
#pragma once

#include "solve/blend_weight_step.h"

#include <Eigen/Core>

#include <algorithm>
#include <utility>

namespace limber::test {

// Q and A, and a gradient that is off by up to what it says, mostly so that weights look worse than
// they are.
class DenseForm final : public BlendForm {
 public:
  DenseForm(Eigen::MatrixXd quadratic, Eigen::MatrixXd rows, double roughness = 0)
      : quadratic_(std::move(quadratic)),
        rows_(std::move(rows)),
        roughness_(roughness) {}

  void Entries(int block, const int* others, size_t count, double* entries) override {
    for (size_t i = 0; i < count; ++i)
      entries[i] = quadratic_(others[i], block);
  }

  void Load(int block, double* load) override {
    std::copy_n(rows_.col(block).eval().data(), rows_.rows(), load);
  }

  void Gradient(const double* blend, const double* residual, double* gradient,
                double* errors) override {
    using Map = Eigen::Map<const Eigen::VectorXd>;
    const Eigen::Index size = quadratic_.rows();
    Eigen::Map<Eigen::VectorXd> out(gradient, size);
    out = quadratic_ * Map(blend, size) + rows_.transpose() * Map(residual, rows_.rows());
    out += roughness_ * (0.75 + 0.25 * Eigen::VectorXd::Random(size).array()).matrix();
    std::fill_n(errors, size, roughness_);
  }

 private:
  Eigen::MatrixXd quadratic_, rows_;
  double roughness_;
};

}  // namespace limber::test
