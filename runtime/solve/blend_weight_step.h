// The convex step (eq. 20) with the transforms eliminated: blend weights B on a product of G
// simplices,
//     minimise  sqrt(f(B)) + l_near . B,     f(B) = 1/2 B^T Q B - l^T B + c0,
// by an active-set method that is exact on each face: on the affine hull of the free weights the
// minimiser has a closed form, so the loop is finite and needs no line search. At a point where f
// vanishes (targets that the examples match exactly) the square root has a kink; f + delta^2 with
// a tiny delta stands for it, which moves B by about delta / sqrt(energy scale).
//
// Where several B serve equally well (an example that moves no handle, shapes equal over a group)
// rounding would choose, differently in each frame. A proximal term rho/2 |B - B_start|^2 within f
// keeps the start instead; it vanishes as B comes to rest, so it changes no settled answer. And a
// start that matches the targets to within the tables' rounding, from the nearest examples alone,
// is kept as it is: what is left of f there is noise, and to follow it would be to drift.
#pragma once

#include <cstdint>
#include <vector>

namespace limber {

// The quadratic form, asked for by columns: only those of weights that become free are computed.
class QuadraticColumns {
 public:
  virtual ~QuadraticColumns() = default;
  // Q(:, block), G*S numbers; valid until the next alternation.
  virtual const double* Column(int block) = 0;
};

struct BlendProblem {
  int num_groups = 0, num_shapes = 0;
  QuadraticColumns* quadratic = nullptr;  // Q
  const double* linear = nullptr;         // l, G*S
  const double* nearness = nullptr;       // lambda sqrt(D), G*S, all >= 0
  double constant = 0;                    // c0
  double delta_squared = 0;               // > 0
  double proximal = 0;                    // rho > 0
  double matched = 0;                     // f at or below which the targets count as matched
};

struct BlendReport {
  int faces = 0;           // faces visited
  double violation = 0;    // largest negative multiplier left, relative to the largest gradient
  bool converged = false;  // false: the visit limit was reached; B is feasible all the same
};

class BlendWeightStep {
 public:
  // All the memory that Solve will ever need: G*S square.
  BlendWeightStep(int num_groups, int num_shapes);

  // blend: in a feasible start (the last frame's answer), out the minimiser. Weights that end at
  // their bound are exactly zero and each group sums to one within rounding.
  BlendReport Solve(const BlendProblem& problem, double* blend);

 private:
  struct Step;

  bool StartIsMatched(const BlendProblem& problem, const double* blend) const;
  void CollectFree(const double* blend);
  void UpdateGradient(const BlendProblem& problem, const double* blend);
  Step MinimiserOnFace(const BlendProblem& problem);
  bool MoveTowards(const Step& step, double* blend);
  double ReleaseBound(const BlendProblem& problem, const double* blend, bool one_only);

  int num_groups_, num_shapes_;
  std::vector<uint8_t> is_free_;  // [G*S]
  std::vector<int> free_;         // free weights that are not their group's reference
  std::vector<int> reference_;    // [G]: the free weight that the others of the group trade with
  std::vector<double> gradient_;  // [G*S] of f: Q B - l + rho (B - B_start)
  std::vector<double> hessian_;   // reduced, free x free
  std::vector<double> newton_, slope_, direction_;  // [free]
  std::vector<double> start_;                       // [G*S]: B at the call
  double value_ = 0;                                // f(B), the proximal term included
};

}  // namespace limber
