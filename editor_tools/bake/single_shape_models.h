// One FAST model (Jacobson et al. 2012) per example shape: the solves behind D of eq. 10.
#pragma once

#include "bake/group_tensors.h"
#include "core/status.h"
#include "core/vector.h"
#include "rig/local_group_factors.h"
#include "rig/rig_tables.h"

#include <Eigen/Core>

namespace limber::bake {

struct SingleShapeInput {
  const Vector<Eigen::MatrixXd>* shapes = nullptr;  // S of V x k, rig space
  const Eigen::MatrixXd* weights = nullptr;         // V x H
  const Vector<GroupTensors>* groups = nullptr;
  const Eigen::SparseMatrix<double>* laplacian = nullptr;  // V x V
  const Vector<int>* handle_vertices = nullptr;            // H
  int num_threads = 0;                                     // 0: one per core
};

// Fills *local, and of *tables num_single_modes, single_handle_modes, single_mode_transforms and
// what follows from *local: single_edges and single_group_factors.
Status BuildSingleShapeModels(const SingleShapeInput& input, RigTables* tables,
                              LocalGroupFactors* local);

}  // namespace limber::bake
