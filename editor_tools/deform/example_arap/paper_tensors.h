// The tensors as the paper prints them (eq. 12 to 19), summed plainly, and the solve for the
// transforms with B and R held: the oracle of the factored reduction.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

namespace limber::deform {

struct PaperTensors {
  int k = 0, num_groups = 0, num_shapes = 0;
  Eigen::MatrixXd skinning;      // M: V x n, columns (h, s, i)
  Eigen::MatrixXd l;             // L~: n x n
  Vector<Eigen::MatrixXd> load;  // K~_gs: G*S of k x n
  Vector<Eigen::MatrixXd> gram;  // H_gss': G*S*S of k x k, (g*S + s)*S + s'

  // Eq. 11: E_d for transforms T^ (n x k).
  double Energy(const Eigen::MatrixXd& transforms, const Vector<double>& blend,
                const Vector<Eigen::MatrixXd>& rotations) const;

  // The T^ of smallest energy whose skinned positions at `vertices` are `targets` (c x k), by a
  // dense least-squares solve of the KKT system (the singular directions of L~ at zero).
  Eigen::MatrixXd Minimise(const Vector<int>& vertices, const Eigen::MatrixXd& targets,
                           const Vector<double>& blend,
                           const Vector<Eigen::MatrixXd>& rotations) const;
};

// shapes: S of V x k. weights: V x H.
PaperTensors BuildPaperTensors(const Vector<Eigen::MatrixXd>& shapes,
                               const Eigen::MatrixXd& weights,
                               const Vector<geometry::GroupEdge>& edges, int num_groups);

}  // namespace limber::deform
