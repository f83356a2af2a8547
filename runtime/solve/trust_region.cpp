#include "solve/trust_region.h"

#include "solve/rotation_planes.h"

#include <algorithm>
#include <cmath>

namespace limber {
namespace {

// mu at the first model step, at least and at most, and what it goes up and down by (the paper's
// rho); one iteration tries so many.
constexpr double kFirstMu = 0.1, kLeastMu = 1e-3, kMostMu = 1e12, kFactor = 10;
constexpr int kMostTries = 12;

// Of the decrease that a step promises this much must come true.
constexpr double kSufficient = 0.1;
// Plain steps that gain less than this of F have done their work: they do not rest where F does.
constexpr double kStalled = 1e-6;
// A model that promises less than this of F, for each undamped step, is at rest.
constexpr double kNegligible = 1e-14;
// A promise below this of F that does not come true is rounding.
constexpr double kResolution = 1e-12;
// A step that goes this well lets the next one go further.
constexpr double kGood = 0.5;
// Steps of D for the same targets.
constexpr int kMostNearnessSteps = 100;

}  // namespace

// f with, spread over Q, the linear term and the constant: Q_ij + (l_i + l_j)/G + 2 c/G^2.
template <int K>
class TrustRegion<K>::ModelForm final : public BlendForm {
 public:
  ModelForm(const PoseModel& model, const TrustRegion& owner, ElasticForm<K>* elastic)
      : groups_(model.num_groups),
        blocks_(static_cast<size_t>(model.num_blocks)),
        owner_(owner),
        elastic_(elastic) {}

  void Entries(int block, const int* others, size_t count, double* entries) override {
    elastic_->Entries(block, others, count, entries);
    const double own = owner_.linear_[static_cast<size_t>(block)] + 2 * owner_.constant_ / groups_;
    for (size_t i = 0; i < count; ++i)
      entries[i] += (own + owner_.linear_[static_cast<size_t>(others[i])]) / groups_;
  }

  void Load(int block, double* load) override { elastic_->Load(block, load); }

  void Gradient(const double* blend, const double* residual, double* gradient,
                double* errors) override {
    elastic_->Gradient(blend, residual, gradient, errors);
    double sum = 0, along = 0;
    for (size_t j = 0; j < blocks_; ++j) {
      sum += blend[j];
      along += blend[j] * owner_.linear_[j];
    }
    const double all = along + 2 * owner_.constant_ / groups_ * sum;
    for (size_t i = 0; i < blocks_; ++i)
      gradient[i] += (all + owner_.linear_[i] * sum) / groups_;
  }

 private:
  double groups_;
  size_t blocks_;
  const TrustRegion& owner_;
  ElasticForm<K>* elastic_;
};

// The weights' cost, scaled as the model's energy is.
template <int K>
class TrustRegion<K>::Term final : public NearnessTerm {
 public:
  Term(const PoseModel& model, Alternation<K>* alternation, double scale)
      : model_(model),
        alternation_(alternation),
        scale_(scale) {}

  Bound Raise(int block, double at_least) override {
    const Bound bound = alternation_->RaiseNearness(model_, block, at_least / scale_);
    return {scale_ * bound.value, bound.is_exact};
  }

 private:
  const PoseModel& model_;
  Alternation<K>* alternation_;
  double scale_;
};

template <int K>
typename TrustRegion<K>::Point TrustRegion<K>::MakePoint(const PoseModel& model) const {
  Point point;
  point.modes.resize(energy_.size());
  point.blend.resize(model.chunks() * kBlockLanes);
  point.rotations.resize(model.chunks() * kBlockLanes * K * K);
  SetIdentity<K>(&point.rotations);
  point.parts = energy_.MakeParts();
  return point;
}

template <int K>
TrustRegion<K>::TrustRegion(const PoseModel& model, size_t max_pins)
    : kernels_(ChooseSolveKernels<K>()),
      energy_(model),
      targets_(std::max(max_pins, model.pins->capacity()) * K),
      smoothing_(kSmoothing * model.energy_scale),
      point_(MakePoint(model)),
      trial_(point_),
      held_(point_.parts),
      slope_(energy_.size()),
      shift_(energy_.size()),
      pulled_(point_.rotations.size()),
      linear_(point_.blend.size()),
      goal_(PaddedSize(K * PinSet::LoadStride(targets_.size() / K))),
      residual_(goal_),
      memory_(model),
      trial_active_(model.num_blocks),
      nearness_(point_.blend.size()),
      changes_(point_.blend.size()),
      transforms_(model.row_chunks() * kBlockLanes * K) {}

template <int K>
ElasticForm<K> TrustRegion<K>::Form(const PoseModel& model) {
  return {model, alternation_->pins(), point_.rotations, nullptr, &memory_};
}

template <int K>
bool TrustRegion<K>::IsOurs(const Settings& settings, const Alternation<K>& alternation) const {
  return has_run_ && settings.lambda == settings_.lambda &&
         settings.rotations == settings_.rotations &&
         settings.square_roots == settings_.square_roots &&
         settings.varying_blend == settings_.varying_blend && alternation.targets == targets_ &&
         alternation.blend() == point_.blend && alternation.rotations() == point_.rotations;
}

template <int K>
typename TrustRegion<K>::Outcome TrustRegion<K>::Run(const PoseModel& model,
                                                     const Settings& settings,
                                                     Alternation<K>* alternation) {
  Outcome outcome;
  const bool goes_on = settings.rotations && IsOurs(settings, *alternation);
  settings_ = settings;
  alternation_ = alternation;
  if (goes_on) {
    Iterate(model, &outcome);
  } else {
    Restart(model, &outcome);
  }
  outcome.objective = point_.objective;
  return outcome;
}

template <int K>
void TrustRegion<K>::Restart(const PoseModel& model, Outcome* outcome) {
  const typename Alternation<K>::Outcome plain = alternation_->Run(model, settings_);
  outcome->change = plain.change;
  outcome->convex = plain.convex;
  outcome->accepted = outcome->restarted = true;
  targets_ = alternation_->targets;
  point_.blend = alternation_->blend();
  point_.rotations = alternation_->rotations();
  LoadModes(model);
  if (settings_.rotations) {
    energy_.FitRotations(model, point_.modes.data(), &point_.rotations);
    energy_.Evaluate(model, point_.modes.data(), point_.blend, point_.rotations, &point_.parts);
    point_.nearness = NearnessOf(model, point_.blend);
    alternation_->Adopt(model, point_.blend, point_.rotations);
  } else {
    point_.parts.energy = alternation_->ElasticEnergy(model, &point_.nearness);
    outcome->settled = plain.convex.converged || model.num_shapes == 1;
  }
  point_.objective = Objective(point_.parts.energy, point_.nearness);
  outcome->before = point_.objective;
  has_run_ = is_plain_ = true;
  nearness_steps_ = 1;
  mu_ = kFirstMu;
}

// z = b + C^T L (L^T (X - C b)): the transforms that the plain step has eliminated.
template <int K>
void TrustRegion<K>::LoadModes(const PoseModel& model) {
  const PinSet& pins = alternation_->pins();
  energy_.Wanted(model, point_.blend, point_.rotations, point_.modes.data());
  energy_.AtPins(pins, point_.modes.data(), residual_.data());
  for (size_t p = 0; p < pins.rank(); ++p) {
    for (size_t c = 0; c < K; ++c) {
      double goal = 0;
      for (size_t pin = 0; pin < pins.size(); ++pin)
        goal += pins.system.root()(static_cast<Eigen::Index>(pin), static_cast<Eigen::Index>(p)) *
                targets_[pin * K + c];
      double& residual = residual_[c * pins.load_stride() + p];
      residual = goal - residual;
    }
  }
  energy_.AddPinned(pins, residual_.data(), point_.modes.data());
}

template <int K>
double TrustRegion<K>::Objective(double elastic, double nearness) const {
  return settings_.square_roots ? std::sqrt(elastic + smoothing_) + nearness : elastic + nearness;
}

template <int K>
double TrustRegion<K>::NearnessOf(const PoseModel& model, const AlignedVector<double>& blend) {
  double nearness = 0;
  for (int i = 0; i < model.num_blocks && model.num_shapes > 1; ++i) {
    const double weight = blend[static_cast<size_t>(i)];
    if (weight != 0) nearness += weight * alternation_->Nearness(model, i);
  }
  return nearness;
}

template <int K>
void TrustRegion<K>::Iterate(const PoseModel& model, Outcome* outcome) {
  const double last = point_.objective;
  if (model.num_shapes > 1 && nearness_steps_ < kMostNearnessSteps) {
    alternation_->AdvanceNearness(model);
    ++nearness_steps_;
    point_.nearness = NearnessOf(model, point_.blend);
    point_.objective = Objective(point_.parts.energy, point_.nearness);
  }
  outcome->before = point_.objective;
  const bool is_same_problem = std::abs(point_.objective - last) <= kResolution * last;
  Form(model).TakeRotations();
  outcome->accepted =
      (is_plain_ && TryPlain(model, outcome)) || (!is_plain_ && TryModel(model, outcome));
  outcome->settled = outcome->settled && is_same_problem;
  outcome->accepted = outcome->accepted && !outcome->settled;
  if (outcome->accepted) Move(model, outcome);
}

// True: to be taken. Where it is not, or is the last one worth while, models follow.
template <int K>
bool TrustRegion<K>::TryPlain(const PoseModel& model, Outcome* outcome) {
  std::fill(slope_.begin(), slope_.end(), 0.0);
  const bool accepted = Try(model, 1, outcome);
  const bool gained = accepted && trial_.objective < (1 - kStalled) * point_.objective;
  // Targets matched to the tables' rounding: what is left of F is not to be followed.
  outcome->settled = !gained && point_.parts.energy <= kMatched * model.energy_scale &&
                     trial_.blend == point_.blend;
  if (outcome->settled) return false;
  is_plain_ = gained;
  return accepted;
}

template <int K>
bool TrustRegion<K>::TryModel(const PoseModel& model, Outcome* outcome) {
  energy_.SlopeThroughRotations(model, point_.modes.data(), point_.blend, point_.rotations,
                                slope_.data());
  energy_.TimesEdges(model, slope_.data(), pulled_.data());
  for (int tries = 0; tries < kMostTries && !outcome->settled; ++tries) {
    const double tau = 1 / (1 + mu_);
    const bool accepted = Try(model, tau, outcome);
    outcome->settled = outcome->predicted <= kNegligible * tau * point_.objective ||
                       (!accepted && outcome->predicted <= kResolution * point_.objective);
    if (accepted) {
      const double decrease = point_.objective - trial_.objective;
      if (decrease >= kGood * outcome->predicted) mu_ = std::max(mu_ / kFactor, kLeastMu);
      return true;
    }
    mu_ = std::min(mu_ * kFactor, kMostMu);
  }
  return false;
}

// The minimiser of the model into trial_; true where F decreases enough there.
template <int K>
bool TrustRegion<K>::Try(const PoseModel& model, double tau, Outcome* outcome) {
  LinearTerms(model, tau);
  trial_.blend = point_.blend;
  if (model.num_shapes > 1) outcome->convex = SolveConvex(model, tau);
  PlaceTrial(model);
  double along = 0;
  for (size_t i = 0; i < slope_.size(); ++i)
    along += slope_[i] * (trial_.modes[i] - point_.modes[i]);
  energy_.Evaluate(model, trial_.modes.data(), trial_.blend, point_.rotations, &held_);
  trial_.nearness = NearnessOf(model, trial_.blend);
  outcome->predicted =
      point_.objective - Objective(std::max(held_.energy + along, 0.0), trial_.nearness);
  trial_.rotations = point_.rotations;
  energy_.FitRotations(model, trial_.modes.data(), &trial_.rotations);
  energy_.Evaluate(model, trial_.modes.data(), trial_.blend, trial_.rotations, &trial_.parts);
  trial_.objective = Objective(trial_.parts.energy, trial_.nearness);
  const double decrease = point_.objective - trial_.objective;
  if (decrease > 0 && decrease >= kSufficient * outcome->predicted) return true;
  ++outcome->rejected;
  return false;
}

// eta, l, c and the goal of the pins.
template <int K>
void TrustRegion<K>::LinearTerms(const PoseModel& model, double tau) {
  const typename ModeEnergy<K>::Parts& parts = point_.parts;
  double squares = 0;
  for (size_t i = 0; i < shift_.size(); ++i) {
    shift_[i] = tau * slope_[i] - (1 - tau) * parts.gap[i];
    squares += shift_[i] * (2 * parts.gap[i] + shift_[i]);
  }
  constant_ = -0.5 * squares - (1 - tau) * parts.energy;
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    const Eigen::Matrix<double, K, K> mixed = tau * MatrixOfBlock<K>(pulled_.data(), i) -
                                              (1 - tau) * MatrixOfBlock<K>(parts.product.data(), i);
    linear_[i] = (MatrixOfBlock<K>(point_.rotations.data(), i) * mixed).trace();
    constant_ -= linear_[i] * point_.blend[i];
  }
  const PinSet& pins = alternation_->pins();
  energy_.AtPins(pins, shift_.data(), goal_.data());
  for (size_t p = 0; p < pins.rank(); ++p) {
    for (size_t pin = 0; pin < pins.size(); ++pin) {
      const double root =
          pins.system.root()(static_cast<Eigen::Index>(pin), static_cast<Eigen::Index>(p));
      for (size_t c = 0; c < K; ++c)
        goal_[c * pins.load_stride() + p] += root * targets_[pin * K + c];
    }
  }
}

template <int K>
BlendReport TrustRegion<K>::SolveConvex(const PoseModel& model, double tau) {
  const double scale = settings_.square_roots ? std::sqrt(tau) : tau;
  for (int i = 0; i < model.num_blocks; ++i)
    nearness_[static_cast<size_t>(i)] = scale * alternation_->NearnessBound(i);
  Term term(model, alternation_, scale);
  ElasticForm<K> elastic = Form(model);
  ModelForm form(model, *this, &elastic);
  BlendProblem problem;
  problem.form = &form;
  problem.num_rows = elastic.num_rows();
  problem.goal = goal_.data();
  problem.nearness = nearness_.data();
  problem.nearness_term = &term;
  problem.square_root = settings_.square_roots;
  problem.delta_squared = tau * smoothing_;
  problem.proximal = (kProximal + (1 - tau) / model.num_groups) * model.energy_scale;
  problem.matched = is_plain_ ? kMatched * model.energy_scale : -1;
  ConvexStep* step = alternation_->convex_step();
  step->Forget();
  const BlendReport report = step->Solve(problem, settings_.varying_blend, trial_.blend.data());
  step->Forget();
  return report;
}

// z = b - eta + C^T L e of the trial's weights.
template <int K>
void TrustRegion<K>::PlaceTrial(const PoseModel& model) {
  const PinSet& pins = alternation_->pins();
  trial_active_.Collect(trial_.blend, point_.rotations);
  residual_ = goal_;
  Form(model).TakeLoads(trial_active_, residual_.data());
  energy_.Wanted(model, trial_.blend, point_.rotations, trial_.modes.data());
  kernels_.add_scaled(-1, shift_.data(), shift_.size() / kBlockLanes, trial_.modes.data());
  energy_.AddPinned(pins, residual_.data(), trial_.modes.data());
}

template <int K>
void TrustRegion<K>::Move(const PoseModel& model, Outcome* outcome) {
  kernels_.rotation_changes(trial_.rotations.data(), point_.rotations.data(), model.chunks(),
                            changes_.data());
  for (size_t i = 0; i < static_cast<size_t>(model.num_blocks); ++i) {
    outcome->change = std::max(outcome->change, std::abs(trial_.blend[i] - point_.blend[i]));
    if (trial_.blend[i] != 0) outcome->change = std::max(outcome->change, changes_[i]);
  }
  std::swap(point_, trial_);
  alternation_->Adopt(model, point_.blend, point_.rotations);
}

template <int K>
const AlignedVector<double>& TrustRegion<K>::Transforms(const PoseModel& model) {
  energy_.Transforms(model, alternation_->pins(), point_.modes.data(), targets_.data(),
                     &transforms_);
  return transforms_;
}

template class TrustRegion<2>;
template class TrustRegion<3>;

}  // namespace limber
