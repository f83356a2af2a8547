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
      goal_(PaddedSize(K * PinSet::LoadStride(targets.size() / K))),
      residual_(goal_),
      changes_(blend_),
      fits_(rotations_),
      pin_values_(targets.size() + size_t{K} * (K + 1)),
      transforms_(model.row_chunks() * kBlockLanes * K),
      failed_(blend_.size()),
      memory_(model),
      convex_step_(kernels_, model.num_groups, model.num_shapes, static_cast<int>(goal_.size())),
      nearness_step_(model, max_pins),
      patch_turns_(max_turns, blend_.size()),
      other_active_(model.num_blocks),
      other_residual_(residual_) {}

template <int K>
typename Alternation<K>::Memory Alternation<K>::MakeMemory(const PoseModel& model) {
  const size_t blocks = model.chunks() * kBlockLanes;
  return {AlignedVector<double>(blocks), AlignedVector<double>(blocks * K * K),
          AlignedVector<double>(blocks * K * K), NearnessStep<K>::MakeMemory(model)};
}

template <int K>
void Alternation<K>::Exchange(Memory* memory) {
  blend_.swap(memory->blend);
  rotations_.swap(memory->rotations);
  memory_.product.swap(memory->product);
  nearness_step_.Exchange(&memory->nearness);
  std::swap(are_identity_, memory->are_identity);
  std::swap(memory_.has_product, memory->has_product);
}

template <int K>
void Alternation<K>::Resume(const PoseModel& model, const PinSet& pins) {
  const bool has_product = memory_.has_product;
  UsePins(pins);
  ElasticForm<K> form = Form(model);
  if (are_identity_) form.TakeRotations();  // else the next rotations will be taken
  memory_.has_active = false;
  form.UseBlend(blend_.data());
  memory_.has_product = has_product;
}

template <int K>
ElasticForm<K> Alternation<K>::Form(const PoseModel& model) {
  return {model, *pins_, rotations_, pins_->turns.empty() ? nullptr : &patch_turns_, &memory_};
}

template <int K>
typename Alternation<K>::Rotation Alternation<K>::rotation(int block) const {
  return MatrixOfBlock<K>(rotations_.data(), static_cast<size_t>(block));
}

template <int K>
void Alternation<K>::HoldRotationsAtIdentity(const PoseModel& model) {
  if (are_identity_) return;
  SetIdentity<K>(&rotations_);
  nearness_step_.Reset();
  RotationsChanged(model);
  are_identity_ = true;
}

template <int K>
void Alternation<K>::RotationsChanged(const PoseModel& model) {
  Form(model).TakeRotations();
  convex_step_.Forget();
  are_identity_ = false;
}

template <int K>
void Alternation<K>::ResetToRest(const PoseModel& model) {
  are_identity_ = false;
  HoldRotationsAtIdentity(model);
  std::fill(blend_.begin(), blend_.end(), 0.0);
  for (int block = 0; block < model.num_blocks; block += model.num_shapes)
    blend_[static_cast<size_t>(block)] = 1;
  UpdateGoal();
  UpdateTurns();
  UpdateResidual(model);
}

template <int K>
void Alternation<K>::UsePins(const PinSet& pins) {
  pins_ = &pins;
  convex_step_.Forget();
}

// L^T X, less what X depends on B, which is in A.
template <int K>
void Alternation<K>::UpdateGoal() {
  for (const TurnedPatch& turn : pins_->turns) {
    const auto first = targets.begin() + static_cast<ptrdiff_t>(turn.first_row * K);
    std::fill_n(first, turn.patch.count * K, 0.0);
  }
  const PinSet& pins = *pins_;
  std::fill(goal_.begin(), goal_.end(), 0.0);
  for (size_t p = 0; p < pins.rank(); ++p) {
    const auto root = pins.system.root().col(static_cast<Eigen::Index>(p));
    for (size_t c = 0; c < K; ++c) {
      double goal = 0;
      for (size_t pin = 0; pin < pins.size(); ++pin)
        goal += root[static_cast<Eigen::Index>(pin)] * targets[pin * K + c];
      goal_[c * pins.load_stride() + p] = goal;
    }
  }
}

// Towards the present targets, as B and R make the patches.
template <int K>
void Alternation<K>::UpdateTurns() {
  if (pins_->turns.empty()) return;
  patch_turns_.Update(kernels_, *pins_, rotations_.data(), blend_.data());
  convex_step_.Forget();
}

// e = L^T X - sum_j B_j L^T V_j^T R_j^T.
template <int K>
void Alternation<K>::UpdateResidual(const PoseModel& model) {
  ElasticForm<K> form = Form(model);
  form.UseBlend(blend_.data());
  residual_ = goal_;
  form.TakeLoads(memory_.active, residual_.data());
}

// K^ and its best rotation (eq. 22, 23), of every shape and group; returns the largest change
// where the shape is in use.
template <int K>
double Alternation<K>::FitRotations(const PoseModel& model) {
  last_rotations_ = rotations_;
  Form(model).Multiply(blend_.data());
  for (size_t i = 0; i < fits_.size(); ++i)
    fits_[i] = -memory_.product[i];
  UpdateResidual(model);  // of the last B and R, for the present targets
  AddNearProducts(kernels_, model, memory_.active, &fits_);
  kernels_.add_loads(pins_->loads.data(), residual_.data(), pins_->rank(), pins_->load_stride(),
                     model.chunks(), fits_.data());
  FitRotationPlanes<K>(kernels_, static_cast<size_t>(model.num_blocks), fits_, rotations_.data(),
                       &failed_);
  RotationsChanged(model);
  kernels_.rotation_changes(rotations_.data(), last_rotations_.data(), model.chunks(),
                            changes_.data());
  double change = 0;
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    if (blend_[i] != 0) change = std::max(change, changes_[i]);
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
  ElasticForm<K> form = Form(model);
  BlendProblem problem;
  problem.form = &form;
  problem.num_rows = form.num_rows();
  problem.goal = goal_.data();
  problem.nearness = nearness_.data();
  problem.nearness_term = &term;
  problem.square_root = settings_.square_roots;
  problem.delta_squared = kSmoothing * model.energy_scale;
  problem.proximal = kProximal * model.energy_scale;
  problem.matched = kMatched * model.energy_scale;
  return convex_step_.Solve(problem, settings_.varying_blend, blend_.data());
}

template <int K>
typename Alternation<K>::Outcome Alternation<K>::Run(const PoseModel& model,
                                                     const Settings& settings) {
  Outcome outcome;
  StageWatch watch(settings.stages);
  settings_ = settings;
  UpdateGoal();
  if (settings.rotations) {
    UpdateTurns();
    outcome.change = FitRotations(model);
  } else {
    HoldRotationsAtIdentity(model);
  }
  UpdateTurns();
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
  watch.Lap(&StageTimes::rotations);
  return outcome;
}

template <int K>
BlendReport Alternation<K>::RepeatConvexStep(const PoseModel& model) {
  if (model.num_shapes == 1) return {};
  blend_ = last_blend_;
  RotationsChanged(model);
  const BlendReport report = SolveConvexStep(model);
  UpdateResidual(model);
  return report;
}

template <int K>
double Alternation<K>::ElasticEnergy(const PoseModel& model, double* nearness) {
  *nearness = 0;
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks) && model.num_shapes > 1; ++i) {
    if (blend_[i] == 0) continue;
    *nearness += blend_[i] * NearnessOf(nearness_step_.Root(model, static_cast<int>(i)));
  }
  const double pins =
      0.5 * kernels_.dot(residual_.data(), residual_.data(), residual_.size() / kBlockLanes);
  return std::max(pins + Form(model).HalfSquare(), 0.0);
}

// T^ = phi_0 t + Phi_1 C^T L e + sum_j Phi_1 K_z,j^T B_j R_j^T, t = w (X - C b).
template <int K>
const AlignedVector<double>& Alternation<K>::TransformsFrom(const PoseModel& model,
                                                            const AlignedVector<double>& blend,
                                                            const ActiveBlocks<K>& active,
                                                            const AlignedVector<double>& residual) {
  const PinSet& pins = *pins_;
  const size_t chunks = model.row_chunks();
  std::fill(transforms_.begin(), transforms_.end(), 0.0);
  std::fill(pin_values_.begin(), pin_values_.end(), 0.0);
  patch_turns_.StorePositions(kernels_, pins, blend.data(), targets.data());
  for (size_t pin = 0; pin < pins.size(); ++pin) {
    for (size_t c = 0; c < K; ++c) {
      pin_values_[c] +=
          pins.system.translation()[static_cast<Eigen::Index>(pin)] * targets[pin * K + c];
    }
  }
  for (size_t p = 0; p < pins.rank(); ++p) {
    for (size_t c = 0; c < K; ++c)
      pin_values_[(1 + p) * K + c] = residual[c * pins.load_stride() + p];
  }
  for (size_t at = 0; at < active.size(); ++at) {
    const double* shift = pins.shifts.data() + active.blocks()[at];
    for (size_t c = 0; c < K; ++c) {
      for (size_t a = 0; a < K; ++a)
        pin_values_[c] -= active.scaled(at)[c * K + a] * shift[a * blend_.size()];
    }
  }
  kernels_.add_transforms(model.transform_response.data(), active.blocks().data(), active.scaled(0),
                          active.size(), chunks, transforms_.data());
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
const AlignedVector<double>& Alternation<K>::Transforms(const PoseModel& model) {
  return TransformsFrom(model, blend_, memory_.active, residual_);
}

template <int K>
void Alternation<K>::Adopt(const PoseModel& model, const AlignedVector<double>& blend,
                           const AlignedVector<double>& rotations) {
  blend_ = blend;
  rotations_ = rotations;
  RotationsChanged(model);
  UpdateTurns();
  UpdateResidual(model);
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
const AlignedVector<double>& Alternation<K>::TransformsOf(const PoseModel& model,
                                                          const AlignedVector<double>& blend,
                                                          const AlignedVector<double>& rotations) {
  const auto turn = [this](const AlignedVector<double>& b, const AlignedVector<double>& r) {
    if (!pins_->turns.empty()) patch_turns_.Update(kernels_, *pins_, r.data(), b.data());
  };
  turn(blend, rotations);
  other_active_.Collect(blend, rotations);
  other_residual_ = goal_;
  Form(model).TakeLoads(other_active_, other_residual_.data());
  (void)TransformsFrom(model, blend, other_active_, other_residual_);
  turn(blend_, rotations_);
  return transforms_;
}

template class Alternation<2>;
template class Alternation<3>;

}  // namespace limber
