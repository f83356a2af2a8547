// What a PoseState is made of. Private to this folder.
#pragma once

#include "solve/alternation.h"
#include "solve/held_points.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"

#include <memory>
#include <variant>
#include <vector>

namespace limber {

class PoseState::Impl {
 public:
  Impl(std::shared_ptr<const PoseModel> model, PoseRoom room);

  void ResetToRest();
  Status Solve(const PoseOptions& options, PoseReport* report);
  void UpdateMatrices();
  Vec3 Place(const SkinPoint& point) const;

  std::shared_ptr<const PoseModel> model;
  HeldPoints held;
  std::vector<float> matrices;  // [H][S][3][4]
  std::variant<Alternation<2>, Alternation<3>> alternation;

 private:
  static std::variant<Alternation<2>, Alternation<3>> MakeAlternation(const PoseModel& model,
                                                                      const HeldPoints& held) {
    if (model.k == 2) return Alternation<2>(model, held.capacity(), held.max_turns());
    return Alternation<3>(model, held.capacity(), held.max_turns());
  }

  Status Check(const PoseOptions& options) const;
  template <int K>
  void Alternate(const PoseOptions& options, Alternation<K>* unknowns, PoseReport* report) const;
  template <int K>
  void ReportEnergy(const PoseOptions& options, Alternation<K>* unknowns, PoseReport* report) const;
};

}  // namespace limber
