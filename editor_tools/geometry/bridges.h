// Connected components, and the bridges that tie loose ones to their neighbours.
#pragma once

#include "geometry/solve_mesh.h"

namespace limber::geometry {

// Fills component, num_components (largest first) and bridges: afterwards triangles and bridges
// together are connected. A small part is tied by several well-spread edges to the nearest vertices
// of the parts already connected, nearest on the first shape; weights are of the order of the
// mean cotangent weight, so that the part follows rigidly without stiffening what it hangs on.
void ConnectComponents(SolveMesh* mesh);

}  // namespace limber::geometry
