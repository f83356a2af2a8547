// The plain alternation and the guaranteed mode side by side on the same targets, both with D at
// rest from the start: one function F(z, B) is what both are measured by. It is computed here
// densely, straight from the rig's tables.
#pragma once

#include "core/rotation_fit.h"
#include "core/vector.h"
#include "rig/rig.h"
#include "solve/trust_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

namespace limber::test {

template <int K>
class GuardedPair {
 public:
  using Settings = typename Alternation<K>::Settings;
  using Outcome = typename TrustRegion<K>::Outcome;
  using Modes = Eigen::Matrix<double, Eigen::Dynamic, K>;  // r x k
  using Small = Eigen::Matrix<double, K, K>;

  explicit GuardedPair(const std::shared_ptr<const Rig>& rig, const Settings& new_settings = {})
      : model(PoseModel::Create(rig).value()),
        settings(new_settings),
        plain(*model),
        guarded(*model),
        trust(*model),
        edges_(Table(rig->tables().mode_edges, model->num_modes)),
        factor_(Table(rig->tables().residual_factor, Eigen::Index{model->num_blocks} * K)) {}

  // Where `shape` has the handles and, at random, about `reach` (rig units) from there.
  AlignedVector<double> TargetsNear(int shape, double reach, std::mt19937* engine) const {
    std::normal_distribution<double> offset;
    const Rig& rig = *model->rig;
    AlignedVector<double> targets(plain.targets.size());
    for (size_t c = 0; c < model->pins->size(); ++c) {
      const auto handle = static_cast<size_t>(model->pinned_handles[c]);
      const size_t first = static_cast<size_t>(shape) * rig.mesh().num_solve_vertices;
      const Vec3 x = rig.mesh().shape_positions[first + rig.tables().handles[handle].vertex];
      for (int axis = 0; axis < K; ++axis)
        targets[c * K + static_cast<size_t>(axis)] =
            static_cast<double>(x[axis]) + reach * offset(*engine);
    }
    return targets;
  }

  // Both from the rest of the first shape to these targets: one alternation, and D to its rest.
  void Pose(const AlignedVector<double>& targets) {
    std::mt19937 engine;
    for (Alternation<K>* one : {&plain, &guarded}) {
      one->targets = TargetsNear(0, 0, &engine);
      one->ResetToRest(*model);
      one->targets = targets;
      one->Run(*model, settings);
      RestNearness(one);
    }
  }

  // The transforms that the alternation's R and B have: z = b + C^T W (X - C b).
  Modes PlainModes() const {
    Modes modes = Wanted(plain.blend(), [&](int i) { return plain.rotation(i); });
    const ConstraintSystem& system = model->pins->system;
    const Modes gap = Targets() - system.modes() * modes;
    return modes + system.modes().transpose() * (system.response() * gap);
  }

  Modes GuardedModes() const {
    const size_t stride = trust.modes().size() / K;
    return Eigen::Map<const Modes, 0, Eigen::OuterStride<>>(
        trust.modes().data(), model->num_modes, K,
        Eigen::OuterStride<>(static_cast<Eigen::Index>(stride)));
  }

  // E_d(z, B, R(z)), the R by singular value decomposition.
  double Elastic(const Modes& modes, const AlignedVector<double>& blend) const {
    const auto fit = [&](int i) {
      return FitRotation<K>(Small(edges_.template middleRows<K>(Eigen::Index{i} * K) * modes));
    };
    Eigen::Matrix<double, Eigen::Dynamic, K> rest;
    rest.setZero(factor_.rows(), K);
    for (int i = 0; i < model->num_blocks; ++i) {
      const double weight = blend[static_cast<size_t>(i)];
      if (weight != 0) {
        rest += weight * factor_.template middleCols<K>(Eigen::Index{i} * K) * fit(i).transpose();
      }
    }
    return 0.5 * (modes - Wanted(blend, fit)).squaredNorm() + 0.5 * rest.squaredNorm();
  }

  // F with D as the guaranteed one's alternation has it now.
  double Objective(const Modes& modes, const AlignedVector<double>& blend) {
    double nearness = 0;
    for (int i = 0; i < model->num_blocks && model->num_shapes > 1; ++i) {
      const double weight = blend[static_cast<size_t>(i)];
      if (weight != 0) nearness += weight * guarded.Nearness(*model, i);
    }
    const double elastic = Elastic(modes, blend);
    if (!settings.square_roots) return elastic + nearness;
    return std::sqrt(elastic + kSmoothing * model->energy_scale) + nearness;
  }

  double PlainObjective() { return Objective(PlainModes(), plain.blend()); }

  double GuardedObjective() { return Objective(GuardedModes(), trust.blend()); }

  // What F falls by along its steepest tangent of the pins, for each unit of z, and along the best
  // trade of two weights of a group, for each unit of B: zero at a stationary point. By differences
  // of the dense F, one-sided in B.
  double SteepestOfModes(const Modes& modes, const AlignedVector<double>& blend) {
    const Modes slope = TangentSlope(modes, blend);
    const double step = 1e-5 * std::sqrt(model->energy_scale) / std::max(slope.norm(), 1e-300);
    const double fall =
        Objective(modes - step * slope, blend) - Objective(modes + step * slope, blend);
    return std::abs(fall) / (2 * step * std::max(slope.norm(), 1e-300));
  }

  double SteepestOfWeights(const Modes& modes, const AlignedVector<double>& blend) {
    const double step = 1e-8, here = Objective(modes, blend);
    double steepest = 0;
    for (int from = 0; from < model->num_blocks; ++from) {
      if (blend[static_cast<size_t>(from)] < step) continue;
      const int first = from - from % model->num_shapes;
      for (int to = first; to < first + model->num_shapes; ++to) {
        AlignedVector<double> moved = blend;
        moved[static_cast<size_t>(from)] -= step;
        moved[static_cast<size_t>(to)] += step;
        steepest = std::max(steepest, (here - Objective(modes, moved)) / step);
      }
    }
    return steepest;
  }

  Outcome RunGuarded() { return trust.Run(*model, settings, &guarded); }

  // X, c x k.
  Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, K, Eigen::RowMajor>> Targets() const {
    return {plain.targets.data(), static_cast<Eigen::Index>(model->pins->size()), K};
  }

  // What is below this in F is the single-precision tables' rounding.
  double Rounding() const { return 1e-6 * std::sqrt(model->energy_scale); }

  std::shared_ptr<const PoseModel> model;
  Settings settings;
  Alternation<K> plain, guarded;
  TrustRegion<K> trust;

 private:
  static Eigen::MatrixXd Table(const Vector<float>& table, Eigen::Index columns) {
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const RowMajor>(table.data(),
                                      static_cast<Eigen::Index>(table.size()) / columns, columns)
        .template cast<double>();
  }

  // Of E_d(z, B, R(z)), without what the pins forbid.
  Modes TangentSlope(const Modes& modes, const AlignedVector<double>& blend) const {
    ModeEnergy<K> energy(*model);
    AlignedVector<double> padded(energy.size()), slope(energy.size());
    const Eigen::OuterStride<> stride(static_cast<Eigen::Index>(energy.size() / K));
    Eigen::Map<Modes, 0, Eigen::OuterStride<>>(padded.data(), model->num_modes, K, stride) = modes;
    AlignedVector<double> rotations = trust.rotations();
    typename ModeEnergy<K>::Parts parts = energy.MakeParts();
    energy.FitRotations(*model, padded.data(), &rotations);
    energy.Evaluate(*model, padded.data(), blend, rotations, &parts);
    energy.SlopeThroughRotations(*model, padded.data(), blend, rotations, slope.data());
    for (size_t i = 0; i < slope.size(); ++i)
      slope[i] += parts.gap[i];
    const Modes whole =
        Eigen::Map<Modes, 0, Eigen::OuterStride<>>(slope.data(), model->num_modes, K, stride);
    const ConstraintSystem& system = model->pins->system;
    return whole - system.modes().transpose() * (system.response() * (system.modes() * whole));
  }

  template <class Rotations>
  Modes Wanted(const AlignedVector<double>& blend, const Rotations& rotation) const {
    Modes modes = Modes::Zero(model->num_modes, K);
    for (int i = 0; i < model->num_blocks; ++i) {
      const double weight = blend[static_cast<size_t>(i)];
      if (weight != 0) {
        modes += weight * edges_.template middleRows<K>(Eigen::Index{i} * K).transpose() *
                 rotation(i).transpose();
      }
    }
    return modes;
  }

  // Single shapes may leave a saddle slowly, so many steps are looked over at once.
  void RestNearness(Alternation<K>* alternation) const {
    if (model->num_shapes == 1) return;
    Vector<double> last(static_cast<size_t>(model->num_blocks));
    for (int round = 0; round < 200; ++round) {
      for (int i = 0; i < 200; ++i)
        alternation->AdvanceNearness(*model);
      double change = 0;
      for (int i = 0; i < model->num_blocks; ++i) {
        const double now = alternation->Nearness(*model, i);
        change = std::max(change, std::abs(now - last[static_cast<size_t>(i)]));
        last[static_cast<size_t>(i)] = now;
      }
      if (change < 1e-13) return;
    }
  }

  Eigen::MatrixXd edges_, factor_;  // K_z and F
};

// What happened over many poses.
struct GuardedStudy {
  int poses = 0;
  int plain_increases = 0, plain_rests = 0;  // poses where the plain one does
  int increases = 0, settled = 0;            // iterations, poses of the guaranteed one
  int lower = 0, higher = 0;                 // its final F, by more than a millionth
  long iterations = 0, rejected = 0;
  double largest_increase = 0, largest_gain = 0;  // of the plain one's F

  void Print(const std::string& name) const {
    std::printf(
        "%s: %d poses; plain: increases F in %d (by up to %.1e of it), rests in %d; guaranteed: "
        "settles in %d, %ld iterations, %ld steps rejected; its last F is lower in %d (up to %.1e "
        "of it), higher in %d\n",
        name.c_str(), poses, plain_increases, largest_increase, plain_rests, settled, iterations,
        rejected, lower, largest_gain, higher);
  }
};

// None negative, each group's sum one.
inline void ExpectOnSimplices(const PoseModel& model, const AlignedVector<double>& blend) {
  for (int first = 0; first < model.num_blocks; first += model.num_shapes) {
    double sum = 0;
    for (int i = first; i < first + model.num_shapes; ++i) {
      EXPECT_GE(blend[static_cast<size_t>(i)], 0);
      sum += blend[static_cast<size_t>(i)];
    }
    EXPECT_NEAR(sum, 1, 1e-9);
  }
}

// Runs both from a pose, each until it rests or `most` iterations are done.
template <int K>
void StudyPose(int most, GuardedPair<K>* pair, GuardedStudy* study) {
  constexpr double kRest = 1e-8;
  ++study->poses;
  const double rounding = 1e-9, noise = pair->Rounding();
  double last = pair->PlainObjective(), change = 1;
  bool increases = false;
  for (int i = 0; i < most && change > kRest; ++i) {
    change = pair->plain.Run(*pair->model, pair->settings).change;
    const double now = pair->PlainObjective();
    if (now > last * (1 + rounding) + noise) {
      increases = true;
      study->largest_increase = std::max(study->largest_increase, now / last - 1);
    }
    last = now;
  }
  study->plain_increases += increases ? 1 : 0;
  study->plain_rests += change <= kRest ? 1 : 0;
  typename GuardedPair<K>::Outcome outcome;
  double now = 0;
  for (int i = 0; i < most && !outcome.settled; ++i) {
    const typename GuardedPair<K>::Modes modes = pair->GuardedModes();
    const AlignedVector<double> blend = pair->trust.blend();
    outcome = pair->RunGuarded();
    now = pair->GuardedObjective();
    ++study->iterations;
    study->rejected += outcome.rejected;
    if (outcome.restarted) continue;
    // By its own account strictly, and by the dense one, with the D of now, to rounding.
    const double before = pair->Objective(modes, blend);
    if (outcome.objective > outcome.before || now > before * (1 + rounding) + 1e-3 * noise)
      ++study->increases;
    EXPECT_NEAR(outcome.objective, now, rounding * now + 1e-3 * noise);
  }
  ExpectOnSimplices(*pair->model, pair->trust.blend());
  study->settled += outcome.settled ? 1 : 0;
  last = pair->PlainObjective();  // with the D of now
  const double gain = last - now, allowed = 1e-6 * last + noise;
  if (gain > allowed) ++study->lower;
  if (gain < -allowed) ++study->higher;
  study->largest_gain = std::max(study->largest_gain, (gain - noise) / last);
}

}  // namespace limber::test
