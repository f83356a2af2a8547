// What a PoseState is made of. Private to this folder.
#pragma once

#include "core/vector.h"
#include "solve/alternation.h"
#include "solve/held_points.h"
#include "solve/motion_smoother.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"
#include "solve/pose_workspaces.h"
#include "solve/stretch_limit.h"
#include "solve/trust_region.h"

#include <memory>
#include <variant>

namespace limber {

// The unknowns of a character of k = K, and who moves them.
template <int K>
struct Unknowns {
  // workspaces: null where the character has an alternation of its own.
  Unknowns(const PoseModel& model, const PoseRoom& room, const PoseWorkspaces* workspaces);

  bool is_lent() const { return own == nullptr; }

  const AlignedVector<double>& blend() const { return is_lent() ? memory.blend : own->blend(); }

  std::unique_ptr<Alternation<K>> own;          // null: lent for each call
  typename Alternation<K>::Memory memory;       // of that one, between the calls
  Alternation<K>* alternation = nullptr;        // own, or lent while a call goes on
  std::unique_ptr<TrustRegion<K>> guarded;      // null: no room was asked for
  std::unique_ptr<MotionSmoother<K>> smoother;  // null: made by the first call that smooths
};

class PoseState::Impl : public NewFromSource {
 public:
  // workspaces: null, or of that model and with that room.
  Impl(std::shared_ptr<const PoseModel> model, PoseRoom room,
       std::shared_ptr<PoseWorkspaces> workspaces);

  void ResetToRest();
  Status Solve(const PoseOptions& options, PoseReport* report);
  Vec3 Place(const SkinPoint& point) const;
  const AlignedVector<double>& blend() const;  // as shown, [padded]

  std::shared_ptr<const PoseModel> model;
  HeldPoints held;
  Vector<float> matrices;  // [H][S][3][4]

 private:
  Status Check(const PoseOptions& options) const;
  template <int K>
  class Lease;

  template <int K>
  void BeginAtRest(Unknowns<K>* unknowns);
  template <int K>
  void SolveFor(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report,
                bool with_energy);
  template <int K>
  void SetTargets(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report);
  template <int K>
  void Alternate(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report) const;
  template <int K>
  void ReportEnergy(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report) const;
  template <int K>
  void Show(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report);

  std::shared_ptr<PoseWorkspaces> workspaces_;
  std::variant<Unknowns<2>, Unknowns<3>> unknowns_;
  std::unique_ptr<StretchLimit> stretch_limit_;  // null: made by the first call that needs it
  bool is_smoothed_ = false;                     // as of the last Solve
};

}  // namespace limber
