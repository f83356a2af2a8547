// Edge groups: k-means on the skinning weights (section 5.2), then spokes-and-rims edge weights.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

namespace limber::bake {

// Group of each vertex, in [0, *num_groups); seeded deterministically (farthest points in weight
// space, then Lloyd). Empty groups are removed, so *num_groups may come back smaller than wanted. A
// group may lie in several pieces: see group_repair.h. num_threads <= 0: one per core; the result
// is the same for any number.
Vector<int> ClusterVertices(const Eigen::MatrixXd& weights, int wanted, int* num_groups,
                            int num_threads = 0);

// Spokes and rims: each triangle gives its three edges, half-cotangent weighted, in equal thirds to
// the groups of its corners; bridges go in halves to the groups of their ends. Entries of one
// (group, edge) are summed, and sums are clamped to a small positive weight. Sorted by group, i, j.
Vector<geometry::GroupEdge> BuildGroupEdges(const geometry::SolveMesh& mesh,
                                            const Vector<int>& vertex_group);

// Makes regions stiffer or softer: an edge's weight is scaled by the geometric mean of its ends'
// factors. vertex_stiffness: V, all above zero.
void ScaleEdges(const Eigen::VectorXd& vertex_stiffness, Vector<geometry::GroupEdge>* edges);

}  // namespace limber::bake
