// Which points are held, and everything about them that a frame needs. Immutable; made from a model
// in O(c^3 + G S k r c) for c pins, whatever the mesh's size.
#pragma once

#include "core/aligned_vector.h"
#include "core/status.h"
#include "rig/rig_tables.h"
#include "solve/constraint_system.h"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace limber {

struct PinSet {
  // handles: those held, ascending, at least one.
  static std::shared_ptr<const PinSet> Create(const RigTables& tables, std::vector<int> handles);

  size_t size() const { return handles.size(); }  // c

  std::vector<int> handles;
  // C, W = L L^T and w: the pins' energy is 1/2 |L^T (X - C b)|^2.
  ConstraintSystem system;

  size_t rank() const { return static_cast<size_t>(system.root.cols()); }  // q

  // V_i L for every block, with V_i = K_z,i C^T: [chunk][k][q][8].
  AlignedVector<double> loads;
  // V_i w^T, what block i shifts the translation by: [k][N padded].
  AlignedVector<double> shifts;
  // The transforms of a translation and those that the pins' residuals ask for, phi_0 | Phi_1 C^T
  // L: 1 + q columns in bunches of k, [bunch][row chunk][k][8].
  AlignedVector<float> transforms;
  // The models of one shape. Rows of C padded with zeros: [S][c][r1 + k padded].
  AlignedVector<double> single_modes;
  std::vector<Eigen::MatrixXd> single_response;  // W, S of c x c
};

}  // namespace limber
