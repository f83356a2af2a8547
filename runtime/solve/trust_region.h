// The guaranteed mode (appendix A of Wampler 2016). The plain alternation fits R to another energy
// than B and T^ are chosen by, so it may increase the objective, or never rest. Here
//     F(z, B) = sqrt(E_d(z, B, R(z)) + delta^2) + lambda sum B sqrt(D)
// with R(z) of eq. 22 always fitted anew never increases while targets and settings stay, and the
// iteration rests only where F has no slope to descend (or E_d is rounding: the targets matched).
//
// The first iteration for new targets is a plain alternation, taken as it is: its transforms meet
// them. After it come plain steps as long as they decrease F as much as they promise; the rest are
// steps of a model of E_d around (z_0, B_0) with R_0 = R(z_0) held,
//     m = E_d(z, B, R_0) + <g, z - z_0> + mu/2 |(z, B) - (z_0, B_0)|_E^2,
// g the slope through R(z) (mode_energy.h), of which sqrt(m + delta^2) + lambda sum B sqrt(D) is
// minimised. The model has F's value and slope at its centre and is above F where mu is large, so
// some mu decreases F wherever anything does; mu goes up tenfold where F did not decrease enough.
//
// The norm is that of E_d's own Hessian, and on top of it the weights' distance, |(w, v)|_E^2 =
// |w - sum_i v_i K_z,i^T R_i^T|^2 + v^T Q v + sigma |v|^2. With tau = 1 / (1 + mu), u_0 = z_0 -
// b_0, eta = tau g - (1 - tau) u_0 and z eliminated as in constraint_system.h,
//     z = b - eta + C^T L e,   e = L^T (X - C b + C eta)
//     tau m = 1/2 B^T Q B + 1/2 |e|^2 + l . (B - B_0) + c + (1 - tau) sigma/2 |B - B_0|^2
//     l_i = tau tr(R_i K_z,i g) - (1 - tau) tr(R_i P_i)
//     c = 1/2 |u_0|^2 - 1/2 |u_0 + eta|^2 - (1 - tau) E_d(z_0, B_0, R_0).
// It is the plain convex step with the same Q and A, another a, and l and c: as sum B = G they are
// quadratic too, l_i/G + l_j/G + 2 (c - l . B_0)/G^2 added to Q_ij.
//
// NOTE: what differs from the paper. It bounds the step by a radius r in T^ and B as they are,
// which have no scale in common and hold T^'s null space; mu stands for the radius, in the energy's
// norm. Its linear term stands outside of the root, ours within it, so that T^ is still eliminated.
// It uses the model from the first step on; ours starts with plain steps, which go further.
#pragma once

#include "core/aligned_vector.h"
#include "core/memory_source.h"
#include "solve/alternation.h"
#include "solve/blend_weight_step.h"
#include "solve/mode_energy.h"
#include "solve/pose_model.h"

namespace limber {

template <int K>
class TrustRegion : public NewFromSource {
 public:
  using Settings = typename Alternation<K>::Settings;

  struct Outcome {
    double before = 0;     // F where the iteration began, with the D that it ended with
    double objective = 0;  // F where it ended
    double predicted = 0;  // decrease that the last step tried had promised
    double change = 0;     // largest change of a blend weight or of a rotation in use
    int rejected = 0;      // steps tried in vain
    bool accepted = false;
    bool restarted = false;  // the plain alternation of new targets: `before` is `objective`
    bool settled = false;    // no descent within rounding
    BlendReport convex;      // of the last step
  };

  // All the memory that Run will ever need. max_pins: as the alternation's.
  explicit TrustRegion(const PoseModel& model, size_t max_pins = 0);

  // What is held has changed: the next Run begins anew. All of it has to be points of the skin that
  // are held exactly.
  void Forget() { has_run_ = false; }

  // One iteration for the alternation's targets, from its blend weights and rotations and from this
  // object's z, or anew where they are not those that the last Run left there. Without rotations
  // the plain step is the global optimum and is taken. D follows the targets for the first
  // hundred iterations and then stays, so F does.
  Outcome Run(const PoseModel& model, const Settings& settings, Alternation<K>* alternation);

  // T^ of the last Run, [row chunk][K][8], valid until the next call. Not the alternation's own.
  const AlignedVector<double>& Transforms(const PoseModel& model);

  // The unknowns after Run: z, [K][stride] (mode_energy.h); B; R(z), planes.
  const AlignedVector<double>& modes() const { return point_.modes; }

  const AlignedVector<double>& blend() const { return point_.blend; }

  const AlignedVector<double>& rotations() const { return point_.rotations; }

  double elastic() const { return point_.parts.energy; }  // E_d(z, B, R(z))

  double nearness() const { return point_.nearness; }  // lambda sum B sqrt(D), or of D

 private:
  struct Point {
    AlignedVector<double> modes, blend, rotations;  // z, B, R(z)
    typename ModeEnergy<K>::Parts parts;
    double nearness = 0, objective = 0;
  };

  class ModelForm;
  class Term;

  ElasticForm<K> Form(const PoseModel& model);
  bool IsOurs(const Settings& settings, const Alternation<K>& alternation) const;
  void Restart(const PoseModel& model, Outcome* outcome);
  void LoadModes(const PoseModel& model);
  void Iterate(const PoseModel& model, Outcome* outcome);
  bool TryPlain(const PoseModel& model, Outcome* outcome);
  bool TryModel(const PoseModel& model, Outcome* outcome);
  bool Try(const PoseModel& model, double tau, Outcome* outcome);
  void LinearTerms(const PoseModel& model, double tau);
  BlendReport SolveConvex(const PoseModel& model, double tau);
  void PlaceTrial(const PoseModel& model);
  void Move(const PoseModel& model, Outcome* outcome);
  double NearnessOf(const PoseModel& model, const AlignedVector<double>& blend);
  double Objective(double elastic, double nearness) const;
  Point MakePoint(const PoseModel& model) const;

  const SolveKernels& kernels_;
  ModeEnergy<K> energy_;
  Settings settings_;
  Alternation<K>* alternation_ = nullptr;  // of the present Run
  AlignedVector<double> targets_;          // of the last Run
  bool has_run_ = false, is_plain_ = false;
  int nearness_steps_ = 0;  // since the targets changed
  double mu_ = 0;
  double smoothing_;  // delta^2
  Point point_, trial_;
  typename ModeEnergy<K>::Parts held_;     // of the trial with R_0
  AlignedVector<double> slope_;            // g, modes
  AlignedVector<double> shift_;            // eta, modes
  AlignedVector<double> pulled_;           // K_z,i g, planes
  AlignedVector<double> linear_;           // l, [padded]
  double constant_ = 0;                    // c - l . B_0
  AlignedVector<double> goal_, residual_;  // L^T (X + C eta) and e, [K][load_stride]
  ElasticMemory<K> memory_;                // of point_.rotations
  ActiveBlocks<K> trial_active_;
  AlignedVector<double> nearness_;  // of each weight, or less, [padded]
  AlignedVector<double> changes_;   // [padded], scratch
  AlignedVector<double> transforms_;
};

extern template class TrustRegion<2>;
extern template class TrustRegion<3>;

}  // namespace limber
