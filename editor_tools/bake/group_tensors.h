// What one edge group contributes to the tensors, kept on the group's own vertices.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace limber::bake {

// With E_g the |edges of g| x S*k matrix of example edges (columns (s, axis)), A_g the edge
// difference operator and C_g the diagonal of edge weights c_ge (eq. 14 to 19):
struct GroupTensors {
  Vector<int> vertices;                   // V_g: ascending solve vertices of the group
  Eigen::SparseMatrix<double> laplacian;  // A_g^T C_g A_g, V_g x V_g
  Eigen::MatrixXd edge_load;              // A_g^T C_g E_g, V_g x S*k: K of eq. 17
  Eigen::MatrixXd shape_gram;             // E_g^T C_g E_g, S*k x S*k: H of eq. 19

  // The rows of `matrix` (V x anything) that belong to this group's vertices.
  Eigen::MatrixXd Rows(const Eigen::MatrixXd& matrix) const;
};

// shapes: S of V x k, rig space. edges: sorted by group, as BuildGroupEdges makes them.
Vector<GroupTensors> BuildGroupTensors(const Vector<Eigen::MatrixXd>& shapes,
                                       const Vector<geometry::GroupEdge>& edges, int num_groups);

// The Laplacian of all groups together, V x V: L of eq. 14.
Eigen::SparseMatrix<double> SumLaplacian(const Vector<geometry::GroupEdge>& edges,
                                         int num_vertices);

}  // namespace limber::bake
