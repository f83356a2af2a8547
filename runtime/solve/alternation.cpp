#include "solve/alternation.h"

#include "core/rotation_fit.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

// All relative to the energy of one example's edges. Tables in single precision leave about 3e-7 of
// its root in sqrt(D), so shapes that fit the targets better than the floor fit equally well.
constexpr double kNearnessFloor = 1e-6;
constexpr double kSmoothing = 1e-14;  // delta^2 of the convex step
constexpr double kProximal = 1e-10;   // rho of the convex step
constexpr double kMatched = 1e-11;    // f that rounding leaves where an example matches exactly

}  // namespace

template <int K>
RotatedColumns<K>::RotatedColumns(const PoseModel& model)
    : model_(model),
      columns_(static_cast<size_t>(model.num_blocks) * static_cast<size_t>(model.num_blocks)),
      is_made_(static_cast<size_t>(model.num_blocks)) {}

template <int K>
void RotatedColumns<K>::Reset(const std::vector<Rotation>* rotations) {
  rotations_ = rotations;
  std::fill(is_made_.begin(), is_made_.end(), uint8_t{0});
}

template <int K>
const double* RotatedColumns<K>::Column(int block) {
  double* column = columns_.data() + static_cast<Eigen::Index>(block) * model_.num_blocks;
  if (is_made_[block] != 0) return column;
  is_made_[block] = 1;
  if (model_.gram.rows() == model_.num_blocks) {  // folded: a rig without rotations
    std::copy_n(model_.gram.col(block).data(), model_.num_blocks, column);
    return column;
  }
  const auto strip = model_.gram.template middleCols<K>(static_cast<Eigen::Index>(block) * K);
  const Rotation turn = (*rotations_)[block].transpose();
  for (int i = 0; i < model_.num_blocks; ++i) {
    const Rotation turned = strip.template middleRows<K>(static_cast<Eigen::Index>(i) * K) * turn;
    column[i] = (*rotations_)[i].transpose().cwiseProduct(turned).sum();
  }
  return column;
}

template <int K>
Alternation<K>::Alternation(const PoseModel& model)
    : targets(Modes::Zero(static_cast<Eigen::Index>(model.pinned.size()), K)),
      rotations_(static_cast<size_t>(model.num_blocks), Rotation::Identity()),
      single_rotations_(rotations_),
      blend_(static_cast<size_t>(model.num_blocks)),
      last_blend_(blend_),
      distances_(blend_),
      linear_(blend_),
      nearness_(blend_),
      modes_(model.num_modes, K),
      answered_targets_(targets),
      fits_(static_cast<Eigen::Index>(model.num_blocks) * K, K),
      columns_(model),
      blend_step_(model.num_groups, model.num_shapes),
      nearness_step_(model),
      energy_(model) {}

template <int K>
void Alternation<K>::HoldRotationsAtIdentity() {
  std::fill(rotations_.begin(), rotations_.end(), Rotation::Identity());
  std::fill(single_rotations_.begin(), single_rotations_.end(), Rotation::Identity());
}

template <int K>
void Alternation<K>::ResetToRest(const PoseModel& model) {
  HoldRotationsAtIdentity();
  std::fill(blend_.begin(), blend_.end(), 0.0);
  for (int block = 0; block < model.num_blocks; block += model.num_shapes) {
    blend_[static_cast<size_t>(block)] = 1;
  }
  energy_.MinimiseModes(model, targets, blend_.data(), rotations_, &modes_, &translation_);
  if (!model.rig->tables().has_rotations) return;
  FitRotations(model);
  single_rotations_ = rotations_;
}

// l_gs = tr(R_gs V_gs^T W X) and c0 = 1/2 tr(X^T W X), with V^T the rows of constraint_load.
template <int K>
void Alternation<K>::PrepareConvexStep(const PoseModel& model, double lambda,
                                       BlendProblem* problem) {
  answered_targets_ = model.constraints.response.lazyProduct(targets);
  const double floor = kNearnessFloor * std::sqrt(model.energy_scale);
  for (int block = 0; block < model.num_blocks; ++block) {
    const Rotation load =
        model.constraint_load.template middleRows<K>(static_cast<Eigen::Index>(block) * K)
            .lazyProduct(answered_targets_);
    linear_[block] = rotations_[block].transpose().cwiseProduct(load).sum();
    nearness_[block] = lambda * std::max(std::sqrt(distances_[block]), floor);
  }
  columns_.Reset(&rotations_);
  problem->num_groups = model.num_groups;
  problem->num_shapes = model.num_shapes;
  problem->quadratic = &columns_;
  problem->linear = linear_.data();
  problem->nearness = nearness_.data();
  problem->constant = 0.5 * targets.cwiseProduct(answered_targets_).sum();
  problem->delta_squared = kSmoothing * model.energy_scale;
  problem->proximal = kProximal * model.energy_scale;
  problem->matched = kMatched * model.energy_scale;
}

// K^_gs = K_z,gs z and its best rotation (eq. 22, 23), of every shape and group; returns the
// largest change of an entry where the shape is in use.
template <int K>
double Alternation<K>::FitRotations(const PoseModel& model) {
  fits_.setZero();
  for (int m = 0; m < model.num_modes; ++m) {
    const float* edges = model.mode_edges.col(m).data();
    for (int c = 0; c < K; ++c) {
      const double mode = modes_(m, c);
      double* fit = fits_.col(c).data();
      for (Eigen::Index i = 0; i < fits_.rows(); ++i)
        fit[i] += mode * static_cast<double>(edges[i]);
    }
  }
  double change = 0;
  for (int block = 0; block < model.num_blocks; ++block) {
    const Rotation fit =
        FitRotation<K>(fits_.template middleRows<K>(static_cast<Eigen::Index>(block) * K));
    if (blend_[block] > 0) {
      change = std::max(change, (fit - rotations_[block]).cwiseAbs().maxCoeff());
    }
    rotations_[block] = fit;
  }
  return change;
}

template <int K>
typename Alternation<K>::Outcome Alternation<K>::Run(const PoseModel& model,
                                                     const Settings& settings) {
  Outcome outcome;
  if (settings.rotations) {
    outcome.change = FitRotations(model);
  } else {
    HoldRotationsAtIdentity();
  }
  if (model.num_shapes > 1) {
    nearness_step_.Run(model, targets, !settings.rotations, &single_rotations_, distances_.data());
    last_blend_ = blend_;
    BlendProblem problem;
    PrepareConvexStep(model, settings.lambda, &problem);
    outcome.optimality = blend_step_.Solve(problem, blend_.data()).violation;
    for (size_t i = 0; i < blend_.size(); ++i) {
      outcome.change = std::max(outcome.change, std::abs(blend_[i] - last_blend_[i]));
    }
  }
  energy_.MinimiseModes(model, targets, blend_.data(), rotations_, &modes_, &translation_);
  return outcome;
}

template <int K>
double Alternation<K>::ElasticRoot(const PoseModel& model, double* nearness) {
  *nearness = 0;
  for (size_t i = 0; i < blend_.size(); ++i)
    *nearness += blend_[i] * nearness_[i];
  return std::sqrt(energy_.Value(model, blend_.data(), rotations_));
}

template <int K>
void Alternation<K>::Transforms(const PoseModel& model,
                                Eigen::Matrix<double, Eigen::Dynamic, K>* out) const {
  const Eigen::Index n = out->rows();
  for (int c = 0; c < K; ++c) {
    double* result = out->col(c).data();
    for (Eigen::Index i = 0; i < n; ++i) {
      result[i] = translation_[c] * static_cast<double>(model.mode_transforms(i, 0));
    }
    for (int m = 0; m < model.num_modes; ++m) {
      const float* transforms = model.mode_transforms.col(1 + m).data();
      const double mode = modes_(m, c);
      for (Eigen::Index i = 0; i < n; ++i)
        result[i] += mode * static_cast<double>(transforms[i]);
    }
  }
}

template class RotatedColumns<2>;
template class RotatedColumns<3>;
template class Alternation<2>;
template class Alternation<3>;

}  // namespace limber
