// What is told of a solution: how far the semidefinite program's conditions of optimality hold.
#pragma once

#include "deform/inversion_free/full_energy.h"

namespace limber::deform {

struct InversionFreeReport {
  int iterations = 0;      // Newton steps in all
  bool converged = false;  // false: stopped before
  double energy = 0;       // E_ex + E_tar (+ incompressibility), without the penalty

  // False: no shape meets the constraints, as with rotations that change wildly from element to
  // element; what was found misses them as little as it can, and elements may be inside out.
  bool feasible = false;

  double smallest_stretch = 0;  // least eigenvalue of any S_i
  double smallest_volume = 0;   // least det F_i
  int num_inverted = 0;         // elements with det F_i <= 0

  // Of the semidefinite program, with the multipliers Z_i that the penalty stands for:
  double primal_violation = 0;  // largest epsilon - eigenvalue of an S_i, 0 where there is none
  double dual_violation = 0;    // largest negative eigenvalue of a Z_i, made positive
  double stationarity = 0;      // |gradient of the Lagrangian|, largest entry
  double duality_gap = 0;       // sum_i <Z_i, S_i - epsilon I>, against the energy
  double target_miss = 0;       // largest distance of a vertex from its target
};

// Fills in all but iterations and converged.
template <int D>
void Measure(const FullEnergy<D>& energy, const InversionFreeOptions& options,
             const typename SimplexMesh<D>::Positions& x, double tau, InversionFreeReport* report);

}  // namespace limber::deform
