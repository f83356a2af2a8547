// Products with large dense matrices, at the speed of the machine: Eigen's take what the baseline
// of the processor family has, a quarter of it or less.
#pragma once

#include "linear/panel_kernels/panel_kernels.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace limber::linear {

// All on num_threads threads (<= 0: one per core), with the same bits for any number.

// a b; meant for many rows of a.
Eigen::MatrixXd Product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, int num_threads,
                        const PanelKernels& kernels = ChoosePanelKernels());

Eigen::MatrixXd Product(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& b,
                        int num_threads);

// a^T b, which must be symmetric; only one half is worked out. Meant for many rows of both.
Eigen::MatrixXd SymmetricProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                 int num_threads,
                                 const PanelKernels& kernels = ChoosePanelKernels());

}  // namespace limber::linear
