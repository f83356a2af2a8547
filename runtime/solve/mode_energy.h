// The elastic energy with the modes z as unknowns of their own, for the guaranteed mode
// (trust_region.h), where the transforms are not those that E_d would choose:
//     E_d(z, B, R) = 1/2 |z - b|^2 + 1/2 |sum_i B_i F_i R_i^T|^2,   b = sum_i B_i K_z,i^T R_i^T
// with R(z) of eq. 22, R_i = argmax tr(R K_z,i z): K^_i = K_z,i z depends on z alone.
//
// Its slope through R(z) (eq. 26 to 30) in adjoint form. E_d = 1/2 |z|^2 - sum_i B_i tr(R_i K^_i)
// + 1/2 sum_ij B_i B_j tr(R_i H_ij R_j^T), j in i's group. R_i maximises its term of the middle
// sum, so with N_i = B_i sum_j B_j H_ij R_j^T and dR_i = [w_i]x R_i
//     dE_d = sum_i tr(dR_i N_i) = -sum_i w_i . ax(R_i N_i),  ax(Z) = (Z32-Z23, Z13-Z31, Z21-Z12).
// R_i K^_i =: S_i stays symmetric, which gives A_i w_i = -ax(R_i dK^_i) with A_i = tr(S_i) I - S_i.
// So with A_i p_i = ax(R_i N_i), dE_d = sum_i tr((R_i^T [p_i]x)^T dK^_i) and
//     g = sum_i K_z,i^T R_i^T [p_i]x:
// one small system a block, none for each scalar of T^. A_i has the eigenvalues D_ii + D_jj of
// eq. 30, none negative. In the plane w, p and A = tr S are numbers, [w]x = w [0 -1; 1 0].
//
// NOTE: where D_ii + D_jj vanishes R jumps and has no slope; A + eps I, eps a billionth of the
// block's size, stands for A.
#pragma once

#include "core/aligned_vector.h"
#include "core/vector.h"
#include "solve/active_blocks.h"
#include "solve/pose_model.h"

#include <Eigen/Core>

#include <cstdint>

namespace limber {

// G = R^T [p]x, A p = ax(R N): what a change of K^ does to tr(R N) through R = argmax tr(R K^),
// d tr(R N) = tr(G^T dK^). Zero where K^ and N are.
template <int K>
Eigen::Matrix<double, K, K> PullBack(const Eigen::Matrix<double, K, K>& fit,
                                     const Eigen::Matrix<double, K, K>& rotation,
                                     const Eigen::Matrix<double, K, K>& pull);

// Modes, here and below: z and its like, k x r as [K][stride] with zeros past r. Planes, blend and
// rotations as in alternation.h.
template <int K>
class ModeEnergy {
 public:
  // What E_d is made of at one point.
  struct Parts {
    AlignedVector<double> gap;      // z - b, modes
    AlignedVector<double> product;  // P_i = sum_j gram_ij B_j R_j^T, planes
    double energy = 0;              // E_d
  };

  explicit ModeEnergy(const PoseModel& model);

  Parts MakeParts() const { return {AlignedVector<double>(size()), fits_, 0}; }

  size_t size() const { return K * stride_; }  // numbers that modes take

  // R(z) of all blocks; in: rotations to start from, which also choose where several serve equally.
  void FitRotations(const PoseModel& model, const double* modes, AlignedVector<double>* rotations);

  void Evaluate(const PoseModel& model, const double* modes, const AlignedVector<double>& blend,
                const AlignedVector<double>& rotations, Parts* parts);

  // g, the slope of E_d(z, B, R(z)) that comes through R(z); rotations: R(z).
  void SlopeThroughRotations(const PoseModel& model, const double* modes,
                             const AlignedVector<double>& blend,
                             const AlignedVector<double>& rotations, double* slope);

  // b.
  void Wanted(const PoseModel& model, const AlignedVector<double>& blend,
              const AlignedVector<double>& rotations, double* modes);

  // K_z,i z of all blocks, as planes.
  void TimesEdges(const PoseModel& model, const double* modes, double* planes) const;

  // T^ of z and the translation that meets the pins, all of them points of the skin, [row
  // chunk][K][8]. targets: X, [c][K].
  void Transforms(const PoseModel& model, const PinSet& pins, const double* modes,
                  const double* targets, AlignedVector<double>* transforms) const;

  // L^T C z, [K][load_stride]; and z += C^T L values.
  void AtPins(const PinSet& pins, const double* modes, double* values) const;
  void AddPinned(const PinSet& pins, const double* values, double* modes) const;

 private:
  void Multiply(const PoseModel& model, AlignedVector<double>* product);
  void AddEdges(const PoseModel& model, int block, const double* m, double* modes) const;

  const SolveKernels& kernels_;
  size_t stride_;
  AlignedVector<double> fits_;     // K^, planes
  AlignedVector<double> near_;     // sum_j B_j H_ij R_j^T, planes
  AlignedVector<double> singles_;  // P, [G*S][K][4]
  ActiveBlocks<K> active_;         // of the last B and R that were given
  Vector<uint8_t> failed_;         // [padded], scratch
};

extern template class ModeEnergy<2>;
extern template class ModeEnergy<3>;

}  // namespace limber
