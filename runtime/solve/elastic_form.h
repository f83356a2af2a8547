// E_d of one character with the transforms eliminated (alternation.h), as the convex step asks for
// it: f(B) = 1/2 B^T Q B + 1/2 |A B - a|^2 with
//     Q_ij = tr(R_i gram_ij R_j^T),   A(:, j) = L^T V_j^T R_j^T, less what turned patches take.
//
// gram is there twice (pose_model.h). Single entries of Q come from the table in double precision,
// since f cancels where the targets are nearly met. Sums over all blocks, P_i = sum_j gram_ij B_j
// R_j^T, read the one in single precision: half the memory, and what the search for weights to free
// and the next rotations need. How far off such a sum can be is told with it.
#pragma once

#include "core/aligned_vector.h"
#include "solve/active_blocks.h"
#include "solve/blend_weight_step.h"
#include "solve/patch_turns.h"
#include "solve/pin_set.h"
#include "solve/pose_model.h"

namespace limber {

// What a form remembers from one call to the next.
template <int K>
struct ElasticMemory {
  explicit ElasticMemory(const PoseModel& model);

  AlignedVector<double> columns;                 // of R: [G*S][K][4]
  ActiveBlocks<K> active;                        // of the last B
  AlignedVector<double> blend;                   // the last B, [padded]
  bool has_active = false, has_product = false;  // of the last B
  AlignedVector<double> product;                 // P, planes
  AlignedVector<double> pulled;                  // P + V L residual, planes
  AlignedVector<double> entries;                 // [padded], scratch
};

template <int K>
class ElasticForm final : public BlendForm {
 public:
  // rotations: R, planes. turns: null where no patch is turned. All outlive this.
  ElasticForm(const PoseModel& model, const PinSet& pins, const AlignedVector<double>& rotations,
              PatchTurns<K>* turns, ElasticMemory<K>* memory);

  // To be called once the rotations have changed.
  void TakeRotations();

  // Rows of A: [K][pins.load_stride()].
  int num_rows() const { return static_cast<int>(K * pins_.load_stride()); }

  void Entries(int block, const int* others, size_t count, double* entries) override;
  void Load(int block, double* load) override;
  void Gradient(const double* blend, const double* residual, double* gradient,
                double* errors) override;

  // Memory's blocks in use of B, and P as well (not of a folded rig); nothing where they are there.
  void UseBlend(const double* blend);
  void Multiply(const double* blend);

  // 1/2 B^T Q B of the last B.
  double HalfSquare();

  // rows -= A B of any B.
  void TakeLoads(const ActiveBlocks<K>& active, double* rows) const;

 private:
  const PoseModel& model_;
  const PinSet& pins_;
  const AlignedVector<double>& rotations_;
  PatchTurns<K>* turns_;
  ElasticMemory<K>& memory_;
  const SolveKernels& kernels_;
};

extern template struct ElasticMemory<2>;
extern template struct ElasticMemory<3>;
extern template class ElasticForm<2>;
extern template class ElasticForm<3>;

}  // namespace limber
