// The reduction: from weights, edge groups and example shapes to the factored tensors of
// RigTables (derivation in REDUCTION.md beside this file; eq. 12 to 19 of Wampler 2016).
#pragma once

#include "bake/bake.h"
#include "core/vector.h"
#include "geometry/solve_mesh.h"
#include "rig/local_group_factors.h"
#include "rig/rig_tables.h"

#include <Eigen/Core>

namespace limber::bake {

struct ReduceInput {
  const geometry::SolveMesh* mesh = nullptr;
  const Eigen::MatrixXd* weights = nullptr;  // V x H
  const Vector<geometry::GroupEdge>* edges = nullptr;
  int num_groups = 0;
  Vector<int> handle_vertices;
  int num_threads = 0;  // 0: one per core; the bits are the same for any number
};

// Fills the counts and all float tables of *tables but handle_reach, and *local, which holds two of
// them as the file does; handles and shape_names must be filled before. tables->dimension and space
// are taken as given (see FitRigSpace).
Status Reduce(const ReduceInput& input, const ProgressCallback& progress, RigTables* tables,
              LocalGroupFactors* local);

}  // namespace limber::bake
