// One character's unknowns and the alternation over them (section 5.5), for k = 2 and 3.
//
// The transforms are eliminated (editor_tools/bake/REDUCTION.md): with P_i = sum_j gram_ij B_j
// R_j^T and the residual of the pins e = L^T (X - sum_j B_j V_j^T R_j^T),
//     E_d      = 1/2 sum_i B_i tr(R_i P_i) + 1/2 |e|^2
//     K^_i     = sum_{j in g(i)} B_j H_ij R_j^T - P_i + V_i L e          (eq. 23)
//     T^       = Phi_1 (sum_j B_j K_z,j^T R_j^T + C^T L e) + phi_0 t
// so a frame is a few products over the blocks in use.
#pragma once

#include "core/aligned_vector.h"
#include "core/memory_source.h"
#include "core/vector.h"
#include "solve/active_blocks.h"
#include "solve/convex_step.h"
#include "solve/elastic_form.h"
#include "solve/nearness_step.h"
#include "solve/patch_turns.h"
#include "solve/pose_model.h"
#include "solve/stage_times.h"

#include <Eigen/Core>

namespace limber {

// Of the convex step, relative to the energy of one example's edges: delta^2, rho, and the f that
// rounding leaves where an example matches exactly.
inline constexpr double kSmoothing = 1e-14;
inline constexpr double kProximal = 1e-10;
inline constexpr double kMatched = 1e-11;

template <int K>
class Alternation : public NewFromSource {
 public:
  using Rotation = Eigen::Matrix<double, K, K>;

  struct Settings {
    double lambda = 0.5;
    bool rotations = true;
    bool square_roots = true;
    bool varying_blend = true;
    StageTimes* stages = nullptr;  // null: not measured; else added to
  };

  struct Outcome {
    double change = 0;   // largest change of a blend weight or of a rotation in use
    BlendReport convex;  // of the convex step
  };

  // What one Run leaves to the next. All else is scratch, so that one alternation can serve many
  // characters in turn: Exchange, Resume, Runs, Exchange.
  struct Memory {
    AlignedVector<double> blend, rotations;  // B and R
    AlignedVector<double> product;           // P of both, where has_product
    typename NearnessStep<K>::Memory nearness;
    bool are_identity = false, has_product = false;
  };

  // Of nobody: to be begun with ResetToRest.
  static Memory MakeMemory(const PoseModel& model);

  // Exchanges this alternation's memory with *memory.
  void Exchange(Memory* memory);

  // After memory was put in: goes on with it, as if nothing else had been here meanwhile (with
  // rotations to the bit; without, the convex step has to ask for its matrices again).
  void Resume(const PoseModel& model, const PinSet& pins);

  // max_pins: rows of the largest pin set that UsePins will see, where larger than the model's own.
  // Begins with that.
  explicit Alternation(const PoseModel& model, size_t max_pins = 0, size_t max_turns = 0);

  const PinSet& pins() const { return *pins_; }

  // What is held from now on; the targets are to be set anew. Outlives its use here.
  void UsePins(const PinSet& pins);

  // The linear term of the convex step, lambda sqrt(D) or lambda D.
  class Term;

  // B on the first shape, all rotations the identity. Targets stay.
  void ResetToRest(const PoseModel& model);
  // R for the present targets and the last B, then D and B (eq. 22, 10, 20).
  Outcome Run(const PoseModel& model, const Settings& settings);
  // The convex step of the last Run once more from where it began, its parts of Q and A computed
  // anew: the same B, to rounding. For measuring that step by itself.
  BlendReport RepeatConvexStep(const PoseModel& model);
  // At the present unknowns E_d, and lambda sum B sqrt(D) (or D) in *nearness, of the last
  // settings.
  double ElasticEnergy(const PoseModel& model, double* nearness);
  // T^: [row chunk][K][8], valid until the next call.
  const AlignedVector<double>& Transforms(const PoseModel& model);
  // The same with other blend weights and rotations, as the unknowns are laid out; held points meet
  // their targets all the same. The unknowns stay.
  const AlignedVector<double>& TransformsOf(const PoseModel& model,
                                            const AlignedVector<double>& blend,
                                            const AlignedVector<double>& rotations);

  AlignedVector<double> targets;  // X, [c][K], rig space, in the pin set's order

  // Of the patches that are turned, as PatchTurns::targets.
  AlignedVector<double>& turn_targets() { return patch_turns_.targets; }

  const AlignedVector<double>& blend() const { return blend_; }

  Rotation rotation(int block) const;  // R

  const AlignedVector<double>& rotations() const { return rotations_; }  // R, planes

  double Distance(const PoseModel& model, int block);  // D

  // For the guaranteed mode (trust_region.h), which moves the unknowns by itself: goes on from
  // these; one more step of D; what a weight costs in the objective of the last Run's settings
  // (lambda sqrt(D) or lambda D), and numbers not above it; and the convex step, which its user
  // has forget before and after.
  void Adopt(const PoseModel& model, const AlignedVector<double>& blend,
             const AlignedVector<double>& rotations);
  void AdvanceNearness(const PoseModel& model);
  double Nearness(const PoseModel& model, int block);
  NearnessTerm::Bound RaiseNearness(const PoseModel& model, int block, double at_least);
  double NearnessBound(int block) const;

  ConvexStep* convex_step() { return &convex_step_; }

 private:
  ElasticForm<K> Form(const PoseModel& model);
  void HoldRotationsAtIdentity(const PoseModel& model);
  double FitRotations(const PoseModel& model);
  void RotationsChanged(const PoseModel& model);
  void UpdateGoal();
  void UpdateTurns();
  void UpdateResidual(const PoseModel& model);
  BlendReport SolveConvexStep(const PoseModel& model);
  const AlignedVector<double>& TransformsFrom(const PoseModel& model,
                                              const AlignedVector<double>& blend,
                                              const ActiveBlocks<K>& active,
                                              const AlignedVector<double>& residual);
  double NearnessOf(double root) const;
  double RootFor(double nearness) const;

  const SolveKernels& kernels_;
  const PinSet* pins_;
  double nearness_floor_;                             // of sqrt(D)
  Settings settings_;                                 // of the last Run
  AlignedVector<double> rotations_, last_rotations_;  // R, planes
  bool are_identity_ = false;                         // all R = I
  AlignedVector<double> blend_, last_blend_;          // B, [padded]
  AlignedVector<double> nearness_;                    // lambda sqrt(D) or less, [padded]
  AlignedVector<double> goal_, residual_;             // L^T X and e, [K][load_stride]
  AlignedVector<double> changes_;                     // of rotations, [padded]
  AlignedVector<double> fits_;                        // K^, planes
  AlignedVector<double> pin_values_;                  // t and e, [1 + q and a little][K]
  AlignedVector<double> transforms_;                  // T^
  Vector<uint8_t> failed_;                            // [padded], scratch
  ElasticMemory<K> memory_;                           // of B and R
  ConvexStep convex_step_;
  NearnessStep<K> nearness_step_;
  PatchTurns<K> patch_turns_;
  ActiveBlocks<K> other_active_;          // TransformsOf's
  AlignedVector<double> other_residual_;  // likewise
};

extern template class Alternation<2>;
extern template class Alternation<3>;

}  // namespace limber
