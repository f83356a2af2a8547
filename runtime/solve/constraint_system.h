// Elimination of the transforms: what is held against whitened modes.
//
// With whitened modes the energy is 1/2 |z - b|^2. A held row asks a t + C z = X, with a = 1 for a
// point of the skin and 0 for a direction, exactly or with a compliance alpha (the energy
// 1/2 |a t + C z - X|^2 / alpha is added). With y the forces, the minimum:
//     y = W (X - C b),   z = b + C^T y,   t = w (X - C b),
//     energy = 1/2 tr(d^T W d),   d = X - C b,
// where W is the pseudo-inverse of C C^T + diag(alpha) with the direction a, the translation,
// projected out. Rows that cannot be met independently are met in the least-squares sense. Costs
// O(c^3) for c rows, whatever the mesh's size, and allocates nothing: rows change while a game
// runs.
#pragma once

#include "core/vector.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace limber {

struct ConstraintRow {
  const double* modes = nullptr;  // C: r
  double translation = 1;         // a
  double compliance = 0;          // alpha >= 0, rig units
};

class ConstraintSystem {
 public:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  ConstraintSystem(size_t max_rows, size_t num_modes);

  size_t bytes() const;  // held in tables

  // rows: 1 to max_rows, one of them at least a point of the skin.
  void Compute(std::span<const ConstraintRow> rows);

  size_t size() const { return size_; }  // c

  size_t rank() const { return rank_; }  // q <= c - 1

  // C, c x r; W, c x c, symmetric positive semi-definite, W a = 0; L, c x q with W = L L^T; w, c.
  Eigen::Map<const RowMajor> modes() const { return {modes_.data(), Rows(), num_modes_}; }

  Eigen::Map<const Eigen::MatrixXd> response() const { return {response_.data(), Rows(), Rows()}; }

  Eigen::Map<const Eigen::MatrixXd> root() const {
    return {root_.data(), Rows(), static_cast<Eigen::Index>(rank_)};
  }

  Eigen::Map<const Eigen::RowVectorXd> translation() const { return {translation_.data(), Rows()}; }

 private:
  using Square = Eigen::Map<Eigen::MatrixXd>;

  Eigen::Index Rows() const { return static_cast<Eigen::Index>(size_); }

  void FillGram(std::span<const ConstraintRow> rows);
  void Reflect(std::span<const ConstraintRow> rows);
  bool InvertByCholesky();
  void InvertByEigenvalues();
  void ReflectBack();
  void FillTranslation(std::span<const ConstraintRow> rows);

  Eigen::Index num_modes_;
  size_t size_ = 0, rank_ = 0;
  Vector<double> modes_, response_, root_, translation_;
  Vector<double> gram_;          // C C^T + diag(alpha): c x c
  Vector<double> reflector_;     // v of the Householder reflection that maps a onto an axis
  double reflector_scale_ = 0;   // 2 / v^T v
  Vector<double> reduced_;       // the gram matrix in the space across a: (c-1) x (c-1)
  Vector<double> factor_;        // scratch, the same size
  Vector<double> reduced_root_;  // of its pseudo-inverse: (c-1) x q
};

}  // namespace limber
