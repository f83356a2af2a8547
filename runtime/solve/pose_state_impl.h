// What a PoseState is made of. Private to this folder.
#pragma once

#include "solve/alternation.h"
#include "solve/held_points.h"
#include "solve/motion_smoother.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"
#include "solve/stretch_limit.h"
#include "solve/trust_region.h"

#include <memory>
#include <variant>
#include <vector>

namespace limber {

// The unknowns of a character of k = K, and who moves them.
template <int K>
struct Unknowns {
  Unknowns(const PoseModel& model, const HeldPoints& held, bool guaranteed)
      : alternation(model, held.capacity(), held.max_turns()),
        guarded(guaranteed ? std::make_unique<TrustRegion<K>>(model, held.capacity()) : nullptr),
        smoother(static_cast<size_t>(model.num_groups), static_cast<size_t>(model.num_shapes)) {}

  Alternation<K> alternation;
  std::unique_ptr<TrustRegion<K>> guarded;  // null: no room was asked for
  MotionSmoother<K> smoother;
};

class PoseState::Impl {
 public:
  Impl(std::shared_ptr<const PoseModel> model, PoseRoom room);

  void ResetToRest();
  Status Solve(const PoseOptions& options, PoseReport* report);
  Vec3 Place(const SkinPoint& point) const;
  const AlignedVector<double>& blend() const;  // as shown, [padded]

  std::shared_ptr<const PoseModel> model;
  HeldPoints held;
  std::vector<float> matrices;  // [H][S][3][4]

 private:
  Status Check(const PoseOptions& options) const;
  template <int K>
  void SetTargets(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report);
  template <int K>
  void Alternate(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report) const;
  template <int K>
  void ReportEnergy(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report) const;
  template <int K>
  void Show(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report);

  std::variant<Unknowns<2>, Unknowns<3>> unknowns_;
  StretchLimit stretch_limit_;
  bool is_smoothed_ = false;  // as of the last Solve
};

}  // namespace limber
