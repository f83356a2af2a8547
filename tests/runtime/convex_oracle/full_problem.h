// Equation 20 of Wampler 2016 for a posed character, the paper's own way: the transforms T^ and the
// blend weights B are both unknowns, the handles' places are equations.
//
// The paper's tensors are the rig's tables multiplied out (editor_tools/bake/REDUCTION.md): with
// the pseudo-inverse Psi of [phi_0 | Phi_1], (t, z) = Psi T^, so
//     L~ = Psi_z^T Psi_z,   K~_gs = K_z,gs Psi_z,   H_gss' = K_z K_z^T + F^T F,
// and E_d = 1/2 |Psi_z T^ - sum B K_z^T R^T|^2 + 1/2 |sum B F R^T|^2 is eq. 11 with those, kept as
// a sum of squares so that no digits cancel. It is the same problem that the runtime reduces, to
// double precision, and knows nothing of how it does.
#pragma once

#include "runtime/convex_oracle/convex_problem.h"
#include "solve/alternation.h"

namespace limber::oracle {

// What stands for the transforms. L~ is singular, so general optimisers have to regularise in T^;
// in the whitened modes it is the identity, which is kinder to them than the paper was.
enum class TransformUnknowns { kTransforms, kModes };

// Makes the convex steps of one rig.
template <int K>
class FullProblem {
 public:
  // model: outlives this.
  FullProblem(const PoseModel& model, TransformUnknowns unknowns);

  // After alternation.Run: the step that it solved (blend weights varying over groups), with its R
  // and D. Unknowns: T^ (or [t; z]) in columns, then B.
  ConvexProblem Make(Alternation<K>* alternation,
                     const typename Alternation<K>::Settings& settings) const;

  // The character's present answer as such unknowns.
  Eigen::VectorXd Unknowns(Alternation<K>* alternation) const;

 private:
  const PoseModel& model_;
  TransformUnknowns unknowns_;
  Eigen::MatrixXd inverse_;   // Psi, (1 + r) x n
  Eigen::MatrixXd modes_;     // [t; z] of the unknowns: Psi, or the identity
  Eigen::MatrixXd handles_;   // rows of M at the pinned handles, for the unknowns
  Eigen::MatrixXd edges_;     // K_z, G*S*k x r
  Eigen::MatrixXd residual_;  // F, rank x G*S*k or rank x G*S
};

// The objective that the runtime reached.
template <int K>
double ReachedObjective(const PoseModel& model, const typename Alternation<K>::Settings& settings,
                        Alternation<K>* alternation);

}  // namespace limber::oracle
