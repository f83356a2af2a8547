#include "solve/alternation.h"

#include "solve/rotation_planes.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

// Relative to the root of the energy of one example's edges. Tables in single precision leave about
// 3e-7 in sqrt(D), so shapes that fit the targets better than the floor fit equally well.
constexpr double kNearnessFloor = 1e-6;

// A bound is raised by so much more than what is asked for that rounding does not have it fail.
constexpr double kRootSlack = 1e-12;

}  // namespace

template <int K>
void RotatedColumns<K>::Column(int block, double* column) {
  if (model_.is_folded) {
    std::copy_n(model_.GramColumn(block), model_.gram_stride, column);
    return;
  }
  double turn[K * K];
  for (size_t entry = 0; entry < size_t{K} * K; ++entry)
    turn[entry] = rotations_[PlaneIndex<K>(static_cast<size_t>(block), entry / K, entry % K)];
  ChooseSolveKernels<K>().rotate_column(model_.GramColumn(block), rotations_.data(), turn,
                                        model_.chunks(), column);
}

template <int K>
void UniformColumns<K>::Column(int shape, double* column) {
  const auto shapes = static_cast<size_t>(model_.num_shapes);
  std::fill_n(column, PaddedSize(shapes), 0.0);
  for (int g = 0; g < model_.num_groups; ++g) {
    varying_->Column(g * model_.num_shapes + shape, scratch_->data());
    for (size_t i = 0; i < static_cast<size_t>(model_.num_blocks); ++i)
      column[i % shapes] += (*scratch_)[i];
  }
}

template <int K>
Alternation<K>::Alternation(const PoseModel& model, size_t max_pins, size_t max_turns)
    : targets(std::max(max_pins, model.pins->capacity()) * K),
      kernels_(ChooseSolveKernels<K>()),
      pins_(model.pins.get()),
      nearness_floor_(kNearnessFloor * std::sqrt(model.energy_scale)),
      rotations_(model.chunks() * kBlockLanes * K * K),
      last_rotations_(rotations_),
      blend_(model.chunks() * kBlockLanes),
      last_blend_(blend_),
      nearness_(blend_),
      rows_(targets.size() * blend_.size()),
      goal_(targets.size()),
      residual_(PaddedSize(goal_.size())),
      column_(blend_),
      product_(rotations_),
      fits_(rotations_),
      pin_values_(goal_.size() + size_t{K} * (K + 1)),
      transforms_(model.row_chunks() * kBlockLanes * K),
      active_(model.num_blocks),
      failed_(blend_.size()),
      blend_step_(kernels_, model.num_groups, model.num_shapes, static_cast<int>(goal_.size())),
      uniform_step_(kernels_, 1, model.num_shapes, static_cast<int>(goal_.size())),
      uniform_blend_(PaddedSize(static_cast<size_t>(model.num_shapes))),
      uniform_nearness_(uniform_blend_),
      uniform_rows_(goal_.size() * uniform_blend_.size()),
      nearness_step_(model, max_pins),
      patch_turns_(max_turns, blend_.size()),
      other_blend_(blend_),
      other_rotations_(rotations_) {}

template <int K>
typename Alternation<K>::Rotation Alternation<K>::rotation(int block) const {
  return MatrixOfBlock<K>(rotations_.data(), static_cast<size_t>(block));
}

template <int K>
void Alternation<K>::HoldRotationsAtIdentity() {
  if (are_identity_) return;
  SetIdentity<K>(&rotations_);
  nearness_step_.Reset();
  blend_step_.ForgetColumns();
  uniform_step_.ForgetColumns();
  are_identity_ = true;
}

template <int K>
void Alternation<K>::ResetToRest(const PoseModel& model) {
  are_identity_ = false;
  HoldRotationsAtIdentity();
  std::fill(blend_.begin(), blend_.end(), 0.0);
  for (int block = 0; block < model.num_blocks; block += model.num_shapes)
    blend_[static_cast<size_t>(block)] = 1;
  UpdateGoal();
  RotateLoads(model);
  UpdateResidual(model);
  UpdateProduct(model);
}

template <int K>
void Alternation<K>::UsePins(const PoseModel& model, const PinSet& pins) {
  pins_ = &pins;
  blend_step_.ForgetColumns();
  uniform_step_.ForgetColumns();
  RotateLoads(model);
}

// L^T X, less what X depends on B, which is in the rows.
template <int K>
void Alternation<K>::UpdateGoal() {
  for (const TurnedPatch& turn : pins_->turns) {
    const auto first = targets.begin() + static_cast<ptrdiff_t>(turn.first_row * K);
    std::fill_n(first, turn.patch.count * K, 0.0);
  }
  const PinSet& pins = *pins_;
  for (size_t p = 0; p < pins.rank(); ++p) {
    const auto root = pins.system.root().col(static_cast<Eigen::Index>(p));
    for (size_t c = 0; c < K; ++c) {
      double goal = 0;
      for (size_t pin = 0; pin < pins.size(); ++pin)
        goal += root[static_cast<Eigen::Index>(pin)] * targets[pin * K + c];
      goal_[p * K + c] = goal;
    }
  }
}

template <int K>
void Alternation<K>::RotateLoads(const PoseModel& model) {
  kernels_.rotate_loads(pins_->loads.data(), rotations_.data(), pins_->rank(), model.chunks(),
                        rows_.data());
  patch_turns_.RotateLoads(kernels_, *pins_, rotations_.data());
  if (pins_->turns.empty()) return;
  patch_turns_.TakeFromRows(kernels_, *pins_, blend_.data(), rows_.data());
  blend_step_.ForgetColumns();  // which hold rows of before, if R did not change them
  uniform_step_.ForgetColumns();
}

// e = L^T X - sum_j B_j L^T V_j^T R_j^T.
template <int K>
void Alternation<K>::UpdateResidual(const PoseModel& model) {
  const size_t rows = pins_->rank() * K;
  kernels_.dot_rows(rows_.data(), blend_.size(), rows, blend_.data(), model.chunks(),
                    residual_.data());
  for (size_t row = 0; row < rows; ++row)
    residual_[row] = goal_[row] - residual_[row];
  std::fill(residual_.begin() + static_cast<ptrdiff_t>(rows), residual_.end(), 0.0);
}

// P_i = sum_j gram_ij B_j R_j^T; of a folded rig it is not needed.
template <int K>
void Alternation<K>::UpdateProduct(const PoseModel& model) {
  active_.Collect(blend_, rotations_);
  if (model.is_folded) return;
  std::fill(product_.begin(), product_.end(), 0.0);
  kernels_.add_products(model.gram.data(), model.gram_stride, active_.blocks().data(),
                        active_.scaled(0), active_.size(), model.chunks(), product_.data());
}

// K^ and its best rotation (eq. 22, 23), of every shape and group; returns the largest change
// where the shape is in use.
template <int K>
double Alternation<K>::FitRotations(const PoseModel& model) {
  are_identity_ = false;
  blend_step_.ForgetColumns();
  uniform_step_.ForgetColumns();
  last_rotations_ = rotations_;
  for (size_t i = 0; i < fits_.size(); ++i)
    fits_[i] = -product_[i];
  AddNearProducts(kernels_, model, active_, &fits_);
  UpdateResidual(model);  // of the last B and R, for the present targets
  kernels_.add_loads(pins_->loads.data(), residual_.data(), pins_->rank(), model.chunks(),
                     fits_.data());
  FitRotationPlanes<K>(kernels_, static_cast<size_t>(model.num_blocks), fits_, rotations_.data(),
                       &failed_);
  kernels_.rotation_changes(rotations_.data(), last_rotations_.data(), model.chunks(),
                            column_.data());
  double change = 0;
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    if (blend_[i] != 0) change = std::max(change, column_[i]);
  }
  return change;
}

template <int K>
class Alternation<K>::Term final : public NearnessTerm {
 public:
  Term(const PoseModel& model, Alternation* owner) : model_(model), owner_(owner) {}

  Bound Raise(int block, double at_least) override {
    return owner_->RaiseNearness(model_, block, at_least);
  }

 private:
  const PoseModel& model_;
  Alternation* owner_;
};

// What a root of D contributes to the objective.
template <int K>
double Alternation<K>::NearnessOf(double root) const {
  const double floored = std::max(root, nearness_floor_);
  return settings_.lambda * (settings_.square_roots ? floored : floored * floored);
}

// The root that contributes so much: any where that is nothing, none where nothing contributes.
template <int K>
double Alternation<K>::RootFor(double nearness) const {
  if (nearness <= 0 || settings_.lambda <= 0) return 0;
  const double share = nearness / settings_.lambda;
  return (settings_.square_roots ? share : std::sqrt(share)) * (1 + kRootSlack);
}

template <int K>
double Alternation<K>::Distance(const PoseModel& model, int block) {
  const double root = nearness_step_.Root(model, block);
  return root * root;
}

template <int K>
BlendReport Alternation<K>::SolveConvexStep(const PoseModel& model) {
  for (int block = 0; block < model.num_blocks; ++block) {
    nearness_[static_cast<size_t>(block)] = NearnessOf(nearness_step_.LowerBound(block));
  }
  Term term(model, this);
  RotatedColumns<K> columns(model, rotations_);
  BlendProblem problem;
  problem.quadratic = &columns;
  problem.num_rows = static_cast<int>(pins_->rank() * K);
  problem.rows = rows_.data();
  problem.goal = goal_.data();
  problem.nearness = nearness_.data();
  problem.nearness_term = &term;
  problem.square_root = settings_.square_roots;
  problem.delta_squared = kSmoothing * model.energy_scale;
  problem.proximal = kProximal * model.energy_scale;
  problem.matched = kMatched * model.energy_scale;
  if (!settings_.varying_blend) return SolveUniformStep(model, problem);
  return blend_step_.Solve(problem, blend_.data());
}

// The same problem with all groups' weights the same: G = 1 and everything summed over groups.
template <int K>
BlendReport Alternation<K>::SolveUniformStep(const PoseModel& model, const BlendProblem& varying) {
  const auto shapes = static_cast<size_t>(model.num_shapes);
  const size_t blocks = static_cast<size_t>(model.num_blocks), padded = PaddedSize(shapes);
  std::fill(uniform_blend_.begin(), uniform_blend_.end(), 0.0);
  std::fill(uniform_nearness_.begin(), uniform_nearness_.end(), 0.0);
  std::fill(uniform_rows_.begin(), uniform_rows_.end(), 0.0);
  for (size_t i = 0; i < blocks; ++i) {
    uniform_blend_[i % shapes] += blend_[i] / model.num_groups;
    uniform_nearness_[i % shapes] += varying.nearness_term->Exact(static_cast<int>(i));
    for (size_t row = 0; row < static_cast<size_t>(varying.num_rows); ++row)
      uniform_rows_[row * padded + i % shapes] += rows_[row * blend_.size() + i];
  }
  UniformColumns<K> columns(model, varying.quadratic, &column_);
  BlendProblem problem = varying;
  problem.quadratic = &columns;
  problem.rows = uniform_rows_.data();
  problem.nearness = uniform_nearness_.data();
  problem.nearness_term = nullptr;  // exact already
  const BlendReport report = uniform_step_.Solve(problem, uniform_blend_.data());
  for (size_t i = 0; i < blocks; ++i)
    blend_[i] = uniform_blend_[i % shapes];
  return report;
}

template <int K>
typename Alternation<K>::Outcome Alternation<K>::Run(const PoseModel& model,
                                                     const Settings& settings) {
  Outcome outcome;
  StageWatch watch(settings.stages);
  settings_ = settings;
  if (!pins_->turns.empty()) RotateLoads(model);  // towards the present targets
  UpdateGoal();
  if (settings.rotations) {
    outcome.change = FitRotations(model);
  } else {
    HoldRotationsAtIdentity();
  }
  RotateLoads(model);
  watch.Lap(&StageTimes::rotations);
  if (model.num_shapes > 1) {
    nearness_step_.Run(model, *pins_, targets.data(), !settings.rotations,
                       patch_turns_.targets.data());
    watch.Lap(&StageTimes::nearness);
    last_blend_ = blend_;
    outcome.convex = SolveConvexStep(model);
    for (size_t i = 0; i < blend_.size(); ++i)
      outcome.change = std::max(outcome.change, std::abs(blend_[i] - last_blend_[i]));
    watch.Lap(&StageTimes::blend);
  }
  UpdateResidual(model);
  UpdateProduct(model);
  watch.Lap(&StageTimes::rotations);
  return outcome;
}

template <int K>
BlendReport Alternation<K>::RepeatConvexStep(const PoseModel& model) {
  if (model.num_shapes == 1) return {};
  blend_ = last_blend_;
  blend_step_.ForgetColumns();
  uniform_step_.ForgetColumns();
  RotateLoads(model);
  const BlendReport report = SolveConvexStep(model);
  active_.Collect(blend_, rotations_);
  return report;
}

template <int K>
double Alternation<K>::ElasticEnergy(const PoseModel& model, double* nearness) {
  *nearness = 0;
  double energy =
      0.5 * kernels_.dot(residual_.data(), residual_.data(), residual_.size() / kBlockLanes);
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    if (blend_[i] == 0) continue;
    if (model.num_shapes > 1) {
      const double root = nearness_step_.Root(model, static_cast<int>(i));
      *nearness += blend_[i] * NearnessOf(root);
    }
    double half = 0;
    if (model.is_folded) {
      half = kernels_.dot(model.GramColumn(static_cast<int>(i)), blend_.data(), model.chunks());
    } else {
      for (size_t c = 0; c < K; ++c) {
        for (size_t a = 0; a < K; ++a)
          half += rotations_[PlaneIndex<K>(i, c, a)] * product_[PlaneIndex<K>(i, a, c)];
      }
    }
    energy += 0.5 * blend_[i] * half;
  }
  return std::max(energy, 0.0);
}

// T^ = phi_0 t + Phi_1 C^T L e + sum_j Phi_1 K_z,j^T B_j R_j^T, t = w (X - C b).
template <int K>
const AlignedVector<double>& Alternation<K>::Transforms(const PoseModel& model) {
  const PinSet& pins = *pins_;
  const size_t chunks = model.row_chunks();
  std::fill(transforms_.begin(), transforms_.end(), 0.0);
  std::fill(pin_values_.begin(), pin_values_.end(), 0.0);
  patch_turns_.StorePositions(kernels_, pins, blend_.data(), targets.data());
  for (size_t pin = 0; pin < pins.size(); ++pin) {
    for (size_t c = 0; c < K; ++c) {
      pin_values_[c] +=
          pins.system.translation()[static_cast<Eigen::Index>(pin)] * targets[pin * K + c];
    }
  }
  std::copy_n(residual_.begin(), pins.rank() * K, pin_values_.begin() + K);
  for (size_t at = 0; at < active_.size(); ++at) {
    const double* shift = pins.shifts.data() + active_.blocks()[at];
    for (size_t c = 0; c < K; ++c) {
      for (size_t a = 0; a < K; ++a)
        pin_values_[c] -= active_.scaled(at)[c * K + a] * shift[a * blend_.size()];
    }
  }
  kernels_.add_transforms(model.transform_response.data(), active_.blocks().data(),
                          active_.scaled(0), active_.size(), chunks, transforms_.data());
  int table = 0;
  for (size_t first = 0; first < 1 + pins.rank(); first += K, ++table) {
    double m[K * K];
    for (size_t c = 0; c < K; ++c) {
      for (size_t b = 0; b < K; ++b)
        m[c * K + b] = pin_values_[(first + b) * K + c];
    }
    kernels_.add_transforms(pins.transforms.data(), &table, m, 1, chunks, transforms_.data());
  }
  return transforms_;
}

template <int K>
void Alternation<K>::Adopt(const PoseModel& model, const AlignedVector<double>& blend,
                           const AlignedVector<double>& rotations) {
  are_identity_ = false;
  blend_ = blend;
  rotations_ = rotations;
  RotateLoads(model);
  UpdateResidual(model);
  UpdateProduct(model);
}

template <int K>
void Alternation<K>::AdvanceNearness(const PoseModel& model) {
  nearness_step_.Run(model, *pins_, targets.data(), !settings_.rotations,
                     patch_turns_.targets.data());
}

template <int K>
double Alternation<K>::Nearness(const PoseModel& model, int block) {
  return NearnessOf(nearness_step_.Root(model, block));
}

template <int K>
NearnessTerm::Bound Alternation<K>::RaiseNearness(const PoseModel& model, int block,
                                                  double at_least) {
  const double bound = nearness_step_.RaiseBound(model, block, RootFor(at_least));
  return {NearnessOf(bound), nearness_step_.is_exact(block)};
}

template <int K>
double Alternation<K>::NearnessBound(int block) const {
  return NearnessOf(nearness_step_.LowerBound(block));
}

template <int K>
BlendWeightStep* Alternation<K>::convex_step() {
  return settings_.varying_blend ? &blend_step_ : &uniform_step_;
}

template <int K>
const AlignedVector<double>& Alternation<K>::TransformsOf(const PoseModel& model,
                                                          const AlignedVector<double>& blend,
                                                          const AlignedVector<double>& rotations) {
  const auto trade_places = [&] {
    blend_.swap(other_blend_);
    rotations_.swap(other_rotations_);
    active_.Collect(blend_, rotations_);
    RotateLoads(model);
    UpdateResidual(model);
  };
  std::copy(blend.begin(), blend.end(), other_blend_.begin());
  std::copy(rotations.begin(), rotations.end(), other_rotations_.begin());
  trade_places();
  (void)Transforms(model);
  trade_places();
  return transforms_;
}

template class RotatedColumns<2>;
template class RotatedColumns<3>;
template class UniformColumns<2>;
template class UniformColumns<3>;
template class Alternation<2>;
template class Alternation<3>;

}  // namespace limber
