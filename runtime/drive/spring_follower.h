// A point that follows a moving goal like a weight on a damped spring, the same whatever the frame
// rate: the goal is taken to move on a straight line during a step, and for that the motion
//     x'' = w^2 (g - x) - 2 d w x'       w = 2 pi frequency, d = damping
// is known in closed form. Two steps are as one of their sum, to rounding.
#pragma once

#include "core/vec3.h"

namespace limber {

struct SpringOptions {
  double frequency = 3;  // Hz, of the spring without damping: how fast it follows; > 0
  double damping = 1;    // 1: as fast as can be without overshoot; below, it swings; >= 0
};

class SpringFollower {
 public:
  // At rest at `position`, which is its goal as well.
  void Reset(Vec3 position);

  // Moves on by `time_step` seconds (>= 0), in which the goal goes to `goal`.
  void Step(const SpringOptions& options, Vec3 goal, double time_step);

  Vec3 position() const;

  // Puts it where it is held back, and takes the part of its velocity that leads on in that
  // direction.
  void HoldAt(Vec3 position);

 private:
  double position_[3] = {}, velocity_[3] = {}, goal_[3] = {};
};

}  // namespace limber
