// The convex step as the alternations take it: blend weights that vary from group to group, or one
// blend for the whole character (G = 1 and everything summed over groups).
#pragma once

#include "core/vector.h"
#include "solve/blend_weight_step.h"

namespace limber {

class ConvexStep {
 public:
  // All the memory that Solve will ever need, as BlendWeightStep.
  ConvexStep(const SolveKernels& kernels, int num_groups, int num_shapes, int max_rows);

  // Q or A has changed.
  void Forget();

  // problem: of weights that vary. blend: G*S, in a feasible start, out the minimiser; where they
  // do not vary all groups get the same, and start from their mean.
  BlendReport Solve(const BlendProblem& problem, bool varies, double* blend);

 private:
  class UniformForm;

  BlendReport SolveUniform(const BlendProblem& varying, double* blend);

  int num_groups_, num_shapes_;
  BlendWeightStep varying_, uniform_;
  Vector<double> blend_, nearness_;                   // [S]
  AlignedVector<double> spread_, gradient_, errors_;  // [G*S padded], scratch
  AlignedVector<double> entries_, load_;              // [G], [rows], scratch
  Vector<int> blocks_;                                // one shape of every group
};

}  // namespace limber
