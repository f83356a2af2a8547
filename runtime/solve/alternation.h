// One character's unknowns and the alternation over them (section 5.5), for k = 2 and 3.
#pragma once

#include "solve/blend_weight_step.h"
#include "solve/nearness_step.h"
#include "solve/pose_model.h"
#include "solve/reduced_energy.h"

#include <Eigen/Core>

#include <vector>

namespace limber {

// Columns of Q_ij = tr(R_i gram_ij R_j^T), made when the convex step first asks for them.
template <int K>
class RotatedColumns final : public QuadraticColumns {
 public:
  using Rotation = Eigen::Matrix<double, K, K>;

  explicit RotatedColumns(const PoseModel& model);
  // Forgets all columns: the rotations have changed.
  void Reset(const std::vector<Rotation>* rotations);
  const double* Column(int block) override;

 private:
  const PoseModel& model_;
  const std::vector<Rotation>* rotations_ = nullptr;
  std::vector<double> columns_;   // [G*S][G*S], a row per column of Q
  std::vector<uint8_t> is_made_;  // [G*S]
};

template <int K>
class Alternation {
 public:
  using Rotation = Eigen::Matrix<double, K, K>;
  using Modes = Eigen::Matrix<double, Eigen::Dynamic, K, Eigen::RowMajor>;

  struct Settings {
    double lambda = 0.5;
    bool rotations = true;
  };

  struct Outcome {
    double change = 0, optimality = 0;
  };

  explicit Alternation(const PoseModel& model);

  // B on the first shape, its rotations the identity, the others' fitted to it.
  void ResetToRest(const PoseModel& model);
  // R from the last z, then D, B and z (eq. 22, 10, 20): afterwards B, R and z belong together.
  Outcome Run(const PoseModel& model, const Settings& settings);
  // Both terms of eq. 10 at the present unknowns: sqrt(E_d), and lambda sum B sqrt(D) in *nearness.
  double ElasticRoot(const PoseModel& model, double* nearness);
  // T^ = Phi [t; z]: n x k into *transforms (column-major, n rows).
  void Transforms(const PoseModel& model, Eigen::Matrix<double, Eigen::Dynamic, K>* out) const;

  Modes targets;  // X, c x k, rig space

  const std::vector<double>& blend() const { return blend_; }

  const std::vector<Rotation>& rotations() const { return rotations_; }  // R, [G*S]

  const std::vector<double>& distances() const { return distances_; }  // D, [G*S]

 private:
  void HoldRotationsAtIdentity();
  void PrepareConvexStep(const PoseModel& model, double lambda, BlendProblem* problem);
  double FitRotations(const PoseModel& model);

  std::vector<Rotation> rotations_;         // R, [G*S]
  std::vector<Rotation> single_rotations_;  // those behind D
  std::vector<double> blend_, last_blend_;  // B
  std::vector<double> distances_;           // D
  std::vector<double> linear_, nearness_;   // l, lambda sqrt(D)
  Modes modes_;                             // z
  Eigen::Matrix<double, 1, K> translation_ = Eigen::Matrix<double, 1, K>::Zero();  // t
  Modes answered_targets_;                                                         // W X, c x k
  Eigen::Matrix<double, Eigen::Dynamic, K> fits_;  // K^ of all blocks, G*S*k x k
  RotatedColumns<K> columns_;
  BlendWeightStep blend_step_;
  NearnessStep<K> nearness_step_;
  ReducedEnergy<K> energy_;
};

extern template class Alternation<2>;
extern template class Alternation<3>;

}  // namespace limber
