// Rig space: centred, about one unit large, and planar characters lie in its xy plane.
#pragma once

#include "geometry/solve_mesh.h"
#include "rig/rig_tables.h"

#include <span>

namespace limber::bake {

// Space for all the shapes together. *dimension is 2 when every shape lies in one plane (to 1e-6 of
// the size), else 3; for 3 the basis is the identity.
RigSpace FitRigSpace(std::span<const geometry::PointMatrix> shapes, int* dimension);

}  // namespace limber::bake
