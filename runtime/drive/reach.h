// How far a handle may go from the others without stretching the character.
#pragma once

#include "core/vec3.h"
#include "solve/pose_solver.h"

namespace limber {

// `goal`, or where it has to stay back so that it is no further from any other pinned handle's
// target than `limit` times the longest way over the skin between the two in any example
// (RigTables::handle_reach): the nearest such point where one other handle holds it back, else one
// near that. It moves no further than the goal does, as long as the others stay. Unlike the
// solver's PoseOptions::stretch_limit, under which all targets give way, this moves one alone;
// where the others are too far apart for any such point it ends between them. Without a reach
// (bakes of version 1) or a limit (0) the goal itself. Allocates nothing. Mesh space.
Vec3 ClampToReach(const PoseState& state, int handle, double limit, Vec3 goal);

}  // namespace limber
