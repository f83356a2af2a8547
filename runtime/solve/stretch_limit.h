// Handle targets that would stretch a character too far give way: the points nearest to the targets
// of which no two are further apart than a limit,
//     min 1/2 sum_a w_a |x_a - X_a|^2   so that   |x_a - x_b| <= r_ab = limit * reach_ab.
// The problem is convex, so the answer is unique and moves no more than the targets do (in the
// norm that is minimised): no jumps, and even motion stays even.
//
// With a multiplier l_ab >= 0 for 1/2 (|x_a - x_b|^2 - r_ab^2) the points are those of springs,
//     (W + Laplacian of l) x = W X,
// and the multipliers maximise the concave dual by Newton steps that keep them non-negative: c x c
// and m x m for the m pairs that pull. NOTE: the step aims at 1 / |x_a - x_b| = 1 / r_ab, which is
// nearly linear in a multiplier (More and Sorensen 1983, for trust regions).
#pragma once

#include "core/aligned_vector.h"
#include "core/memory_source.h"
#include "core/vector.h"
#include "solve/kernels/solve_kernels.h"

#include <cstddef>
#include <span>

namespace limber {

class StretchLimit : public NewFromSource {
 public:
  struct Outcome {
    int pairs_at_limit = 0;  // that hold points back
    double violation = 0;    // largest excess left, of the pair's limit
    int iterations = 0;      // 0: nothing had to give way
    bool is_feasible =
        true;  // false: immovable points are too far apart, or the iterations ran out
  };

  // All the memory that Project will ever need: some 16 c^2 numbers and those of the pairs.
  explicit StretchLimit(size_t max_points);

  // What the limits are among some of a rig's handles. Nothing is copied.
  struct Problem {
    size_t dimension = 3;             // k: 2 or 3
    std::span<const int> handles;     // whose points these are
    const float* reach = nullptr;     // [H][H] of the rig, 0: no limit for the pair
    size_t num_handles = 0;           // H
    const double* weights = nullptr;  // w, [H] > 0; infinite: does not give way at all
    double limit = 1;                 // of the reach
  };

  // points: in X, out x, [handles][k].
  Outcome Project(const Problem& problem, double* points);

 private:
  struct Pair {
    size_t a = 0, b = 0;
    double limit = 0;
    double multiplier = 0, trial = 0;  // l
    double apart[3] = {};              // x_a - x_b
    double length = 0;                 // of that
  };

  void CollectPairs(const Problem& problem, const double* points);
  double Place(const Problem& problem, bool trial);
  bool ChooseActive();
  bool IsSolved() const;
  void NewtonStep(size_t dimension, bool reciprocal);
  void StepWithinBounds(size_t count, size_t stride);
  bool Ascend(const Problem& problem, double* value);

  const SolveKernels& kernels_;
  size_t max_points_, stride_;  // and the same in whole chunks
  size_t max_active_, active_stride_;
  Vector<Pair> pairs_;
  Vector<size_t> active_;               // pairs that pull, or that ought to
  Vector<double> weights_;              // w by point
  Vector<double> targets_, x_;          // [c][3]
  AlignedVector<double> factor_;        // of W + Laplacian; rows of immovable points the identity's
  AlignedVector<double> inverse_;       // columns of its inverse
  AlignedVector<double> hessian_;       // of the dual, active pairs
  AlignedVector<double> step_, slope_;  // [active]
  AlignedVector<double> column_;        // scratch
};

}  // namespace limber
