// Handles: from wishes to distinct vertices of the welded mesh, or chosen automatically.
#pragma once

#include "bake/bake.h"
#include "core/vector.h"
#include "geometry/solve_mesh.h"

#include <span>

namespace limber::bake {

struct ResolvedHandle {
  HandleSpec spec;
  int vertex = 0;  // solve vertex
};

// Snaps each wish to a solve vertex. Errors, each naming the handle: kNoHandles (none, or none
// pinned), kInvalidArgument (vertex out of range, two of one name, two on one vertex, not finite,
// a stiffness out of range).
Result<Vector<ResolvedHandle>> ResolveHandles(const RawCharacter& raw,
                                              const geometry::SolveMesh& mesh,
                                              std::span<const HandleSpec> specs);

// `count` handles spread over the extremities: farthest-point sampling by distance along the
// surface (bridges included), starting at the tip farthest from the centre, each then moved to the
// local extremity. Named "handle_0"... All pinned. Deterministic.
Vector<HandleSpec> ChooseHandles(const RawCharacter& raw, const geometry::SolveMesh& mesh,
                                 int count);

}  // namespace limber::bake
