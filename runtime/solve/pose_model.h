// What follows from a rig and its pinned handles, shared by all its characters. Immutable.
#pragma once

#include "core/status.h"
#include "rig/rig.h"
#include "solve/constraint_system.h"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace limber {

class PoseModel {
 public:
  // Builds the matrices below, in double from the rig's single-precision tables: time and memory
  // grow with (G*S*k)^2. Errors: kNoHandles, kLimitExceeded.
  static Result<std::shared_ptr<const PoseModel>> Create(std::shared_ptr<const Rig> rig);

  std::shared_ptr<const Rig> rig;
  int k = 0, num_groups = 0, num_shapes = 0, num_modes = 0, num_single_modes = 0;  // k G S r r1
  int num_blocks = 0;              // G*S, numbered g*S + s
  std::vector<int> pinned;         // c handles, ascending
  std::vector<int> pin_of_handle;  // [H]: index into pinned, -1 for a free handle

  ConstraintSystem constraints;                      // on the full model
  std::vector<ConstraintSystem> single_constraints;  // S, on the models of one shape
  // Rows (g, s, axis) of K_z C^T: what the examples' edges ask of the pinned points. G*S*k x c.
  Eigen::MatrixXd constraint_load;
  // The energy left after the transforms are eliminated: blocks F_i^T F_j + V_i^T W V_j, of which
  // Q_ij = tr(R_i gram_ij R_j^T). G*S*k square; folded to G*S square for a rig without rotations.
  Eigen::MatrixXd gram;
  // Tables again with the long side contiguous, so that products run over it.
  Eigen::MatrixXf mode_edges;       // G*S*k x r, column-major
  Eigen::MatrixXf mode_transforms;  // n x (1 + r), column-major
  double energy_scale = 0;          // 1/2 mean over shapes of tr H: the size of one example's edges

 private:
  PoseModel() = default;
};

}  // namespace limber
