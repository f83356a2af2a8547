// A path that drags a character through all that it knows, and what an alternation costs along it.
#pragma once

#include "core/vector.h"
#include "rig/rig.h"
#include "solve/pose_solver.h"

#include <functional>
#include <memory>

namespace limber::bench {

// Targets of one frame, [H], mesh space: the handles go from example shape to example shape and
// round again, while each sways on its own, so that the active shapes change along the way.
Vector<Vector<Vec3>> DragPath(const Rig& rig, int num_frames);

// Sets every pinned handle's target; the first error, if any.
Status SetTargets(const Vector<Vec3>& targets, PoseState* pose);

// Seconds on the clock of one alternation a frame: targets in, skinning matrices out.
struct AlternationTimes {
  double median = 0, mean = 0;
  StageTimes stages;  // the median of each for itself
};

// Warm, along the path above, frame by frame; without rotations where the rig was baked so.
// progress is asked after each frame with the fraction done: false cancels (kInvalidArgument).
// Errors: of PoseState.
Result<AlternationTimes> TimeAlternations(const std::shared_ptr<const Rig>& rig, int num_frames,
                                          const std::function<bool(double)>& progress);

}  // namespace limber::bench
