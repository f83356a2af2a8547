// Edge groups in one piece each.
#pragma once

#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <Eigen/Core>

namespace limber::bake {

// k-means on weights knows nothing of the surface: a group may be a region of the back and a crumb
// on the chest where the weights happen to be alike, and a group rotates as one. Of each group its
// largest piece (over triangles and bridges; the one with the first vertex of equals) stays; every
// other piece joins, whole, the group next to it whose mean weights are nearest to its own. Numbers
// of groups stay, none becomes empty. Returns how many vertices changed their group.
// weights: V x H; vertex_group: [V], in [0, num_groups); the mesh is connected (ConnectComponents).
int ConnectGroups(const geometry::SolveMesh& mesh, const Eigen::MatrixXd& weights, int num_groups,
                  Vector<int>* vertex_group);

}  // namespace limber::bake
