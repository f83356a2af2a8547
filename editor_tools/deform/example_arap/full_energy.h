// The AMRAP energies summed edge by edge over the full mesh (Wampler 2016, eq. 7 to 10), slowly
// and plainly: what the reduced solver is checked against.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

namespace limber::deform {

// One set of unknowns. Blocks are numbered g*S + s.
struct ExampleState {
  Eigen::MatrixXd q;                  // deformed positions, V x k
  Vector<double> blend;               // B, G*S
  Vector<Eigen::MatrixXd> rotations;  // R, G*S of k x k
};

// E_d of eq. 9. shapes: S of V x k.
double ElasticEnergy(const Vector<Eigen::MatrixXd>& shapes,
                     const Vector<geometry::GroupEdge>& edges, const ExampleState& state);

// E_g(q, R, p_s) of eq. 7, without the factor 1/2, for one shape and group.
double GroupEnergy(const Eigen::MatrixXd& shape, const Vector<geometry::GroupEdge>& edges,
                   int group, const Eigen::MatrixXd& q, const Eigen::MatrixXd& rotation);

}  // namespace limber::deform
