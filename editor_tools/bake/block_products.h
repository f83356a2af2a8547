// Products of tall matrices on several threads. Blocks are of one size whatever the number of
// threads, so that the bits are too. num_threads <= 0: one per core.
#pragma once

#include <Eigen/Core>

namespace limber::bake {

// a b.
Eigen::MatrixXd Product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, int num_threads);

// a^T b, known to be symmetric: half of it is computed.
Eigen::MatrixXd SymmetricProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                 int num_threads);

}  // namespace limber::bake
