// The convex step (eq. 20) with the transforms eliminated: blend weights B on a product of G
// simplices,
//     minimise  sqrt(f(B)) + l_near . B,     f(B) = 1/2 B^T Q B + 1/2 |A B - a|^2,
// by an active-set method that is exact on each face: on the affine hull of the free weights the
// minimiser has a closed form, so the loop is finite and needs no line search. Faces are worked on
// in the coordinates of the few weights in use; the others are priced, one product, when a face
// is done. That product may be rough if it says how rough: a weight that it does not rule out is
// priced once more, exactly. At a point where f vanishes (targets that the examples match exactly)
// the square root has a kink; f + delta^2 with a tiny delta stands for it, which moves B by about
// delta / sqrt(energy scale).
//
// Where several B serve equally well (an example that moves no handle, shapes equal over a group)
// rounding would choose, differently in each frame. A proximal term rho/2 |B - B_start|^2 within f
// keeps the start instead; it vanishes as B comes to rest, so it changes no settled answer. And a
// start that matches the targets to within the tables' rounding, from the nearest examples alone,
// is kept as it is: what is left of f there is noise, and to follow it would be to drift.
#pragma once

#include "core/aligned_vector.h"
#include "core/vector.h"
#include "solve/kernels/solve_kernels.h"

#include <cstdint>
#include <limits>

namespace limber {

// Q and A, asked for as far as they are needed.
class BlendForm {
 public:
  virtual ~BlendForm() = default;
  // Q(others[i], block), exactly.
  virtual void Entries(int block, const int* others, size_t count, double* entries) = 0;
  // A(:, block).
  virtual void Load(int block, double* load) = 0;
  // Q B + A^T residual, of G*S weights, padded with anything, to within `errors`.
  virtual void Gradient(const double* blend, const double* residual, double* gradient,
                        double* errors) = 0;
};

// The linear term, exact where it is asked for; elsewhere BlendProblem::nearness holds lower
// bounds.
class NearnessTerm {
 public:
  struct Bound {
    double value;
    bool is_exact;
  };

  virtual ~NearnessTerm() = default;
  // The term, or a lower bound of it that is at_least that.
  virtual Bound Raise(int block, double at_least) = 0;

  double Exact(int block) { return Raise(block, std::numeric_limits<double>::infinity()).value; }
};

struct BlendProblem {
  BlendForm* form = nullptr;     // Q, positive semi-definite, and A
  int num_rows = 0;              // of A
  const double* goal = nullptr;  // a, [num_rows]
  // lambda sqrt(D), G*S, all >= 0; where there is a term, lower bounds of it.
  const double* nearness = nullptr;
  NearnessTerm* nearness_term = nullptr;
  bool square_root = true;   // false: f(B) + l_near . B, a quadratic program
  double delta_squared = 0;  // > 0
  double proximal = 0;       // rho > 0
  double matched = 0;        // f at or below which the targets count as matched
};

struct BlendReport {
  int faces = 0;         // faces visited
  int used = 0;          // weights that were free at some time
  double violation = 0;  // largest negative multiplier left, relative to the largest gradient
  // False: the limit of visits, or of weights in use, was reached; B is feasible all the same.
  bool converged = false;
};

class BlendWeightStep {
 public:
  // All the memory that Solve will ever need, with at most max_rows rows of A.
  BlendWeightStep(const SolveKernels& kernels, int num_groups, int num_shapes, int max_rows);

  // Q or A has changed: forgets what was asked of them. Solve keeps it otherwise.
  void Forget();

  // blend: in a feasible start (the last frame's answer), out the minimiser. Weights that end at
  // their bound are exactly zero and each group sums to one within rounding.
  BlendReport Solve(const BlendProblem& problem, double* blend);

 private:
  bool Use(const BlendProblem& problem, int block, const double* blend);
  void DropUnused(const double* blend);
  bool StartIsMatched(const BlendProblem& problem, const double* blend);
  double Nearness(const BlendProblem& problem, int block);
  bool IsNearnessAtLeast(const BlendProblem& problem, int block, double level);
  void PriceExactly(const BlendProblem& problem, int block);
  void CollectFree(const double* blend);
  void UpdateUsedGradient(const BlendProblem& problem, const double* blend);
  void UpdateFullGradient(const BlendProblem& problem, const double* blend);
  void BuildHessian(const BlendProblem& problem);
  bool MinimiserOnFace(const BlendProblem& problem);
  bool MoveTowards(bool bounded, double* blend);
  bool ReleaseBound(const BlendProblem& problem, const double* blend, bool one_only,
                    BlendReport* report);
  double Objective(const BlendProblem& problem, const double* blend) const;
  double WorstOfGroup(const BlendProblem& problem, const double* blend, int group, double outer,
                      double tolerance, int* block);

  const SolveKernels& kernels_;
  int num_groups_, num_shapes_, num_blocks_, max_used_;
  size_t row_stride_, used_stride_;  // rows and max_used in whole chunks

  // The weights in use, by slot.
  Vector<int> used_;                 // block of each slot
  Vector<int> slot_;                 // [G*S]: slot of each block, -1 for none
  AlignedVector<double> loads_;      // A(:, block), [max_used][row_stride]
  AlignedVector<double> quadratic_;  // Q among them, [max_used][used_stride]

  Vector<uint8_t> is_free_;         // [G*S]
  Vector<int> free_;                // free weights that are not their group's reference
  Vector<int> reference_;           // [G]: the free weight that the others of the group trade with
  Vector<double> nearness_;         // [G*S]: the linear term, exact where exact_ says so
  Vector<uint8_t> is_exact_;        // [G*S]
  AlignedVector<double> gradient_;  // [padded] of f at B, the proximal term included
  AlignedVector<double> errors_;    // [padded] of it at most
  AlignedVector<double> residual_;  // A B - a, [row_stride]
  AlignedVector<double> load_;      // of a weight without a slot, [row_stride]
  AlignedVector<double> start_;     // [G*S]: B at the call
  AlignedVector<double> hessian_;   // reduced, free x free in columns
  AlignedVector<double> weights_;   // [used_stride]: B by slot
  AlignedVector<double> used_gradient_;  // [used_stride]: of f by slot, the proximal term included
  AlignedVector<double> slot_changes_;   // [used_stride]: A^T (A B - a); one row of Q less another
  AlignedVector<double> trades_;         // [free][row_stride]: A's columns less their references'
  AlignedVector<double> newton_, slope_, direction_;  // [free padded]
  double value_ = 0;                                  // f(B), the proximal term included
};

}  // namespace limber
