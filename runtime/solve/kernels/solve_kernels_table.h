// Gathers one instruction set's functions. Included last by each of its source files.
#pragma once

#include "solve/kernels/fit_rotations_body.h"
#include "solve/kernels/solve_kernels_body.h"

namespace limber::LIMBER_KERNEL_NAMESPACE {

template <int K>
static constexpr SolveKernels MakeTable(const char* instruction_set) {
  return {instruction_set,
          AddScaled,
          Dot,
          DotRows,
          AddRows,
          AddProducts<K, double>,
          AddProducts<K, float>,
          Traces<K>,
          AddSingleProducts<K>,
          TurnedEntries<K>,
          AddTurnedRows<K>,
          RotateLoads<K>,
          AddLoads<K>,
          FitRotations<K>,
          RotationChanges<K>,
          SingleModes<K>,
          SingleFits<K>,
          SingleEnergy<K>,
          AddTransforms<K>,
          CholeskyFactor,
          CholeskySolve};
}

}  // namespace limber::LIMBER_KERNEL_NAMESPACE
