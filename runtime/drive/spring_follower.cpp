#include "drive/spring_follower.h"

#include <cmath>
#include <numbers>

namespace limber {
namespace {

// After t seconds, how much of the distance from the goal and of the velocity against it remains:
// x = a x0 + b v0, v = c x0 + e v0.
struct Decay {
  double a, b, c, e;
};

// The homogeneous solution; near d = 1 its parts' quotients are taken in the limit.
Decay DecayOf(double w, double d, double t) {
  const double s = 1 - d * d;  // > 0: swings
  const double fading = std::exp(-d * w * t);
  double cosine = 1, sine_over = t;  // cos(r t), sin(r t) / r with r = w sqrt(s); or of cosh, sinh
  const double r = w * std::sqrt(std::abs(s));
  if (r * t > 1e-4) {
    cosine = s > 0 ? std::cos(r * t) : std::cosh(r * t);
    sine_over = (s > 0 ? std::sin(r * t) : std::sinh(r * t)) / r;
  } else {
    const double q = (s > 0 ? -1 : 1) * r * r * t * t;
    cosine = 1 + q / 2;
    sine_over = t * (1 + q / 6);
  }
  return {fading * (cosine + d * w * sine_over), fading * sine_over, -fading * w * w * sine_over,
          fading * (cosine - d * w * sine_over)};
}

// The same where overdamping and a long step would make an infinity times zero of it.
Decay OverdampedDecayOf(double w, double d, double t) {
  const double root = w * std::sqrt(d * d - 1);
  const double slow = w / (d + std::sqrt(d * d - 1)), fast = d * w + root;  // rates; slow > 0
  const double slow_part = std::exp(-slow * t), fast_part = std::exp(-fast * t);
  const double over = 1 / (fast - slow);
  return {(fast * slow_part - slow * fast_part) * over, (slow_part - fast_part) * over,
          -slow * fast * (slow_part - fast_part) * over,
          (fast * fast_part - slow * slow_part) * over};
}

}  // namespace

void SpringFollower::Reset(Vec3 position) {
  const double at[3] = {position.x, position.y, position.z};
  for (int i = 0; i < 3; ++i) {
    position_[i] = goal_[i] = at[i];
    velocity_[i] = 0;
  }
}

Vec3 SpringFollower::position() const {
  return {static_cast<float>(position_[0]), static_cast<float>(position_[1]),
          static_cast<float>(position_[2])};
}

void SpringFollower::Step(const SpringOptions& options, Vec3 goal, double time_step) {
  if (!(time_step > 0)) return;
  const double w = 2 * std::numbers::pi * options.frequency, d = options.damping;
  const Decay decay = d > 1.001 ? OverdampedDecayOf(w, d, time_step) : DecayOf(w, d, time_step);
  const double to[3] = {goal.x, goal.y, goal.z};
  for (int i = 0; i < 3; ++i) {
    // Behind a goal of constant velocity u the weight would stay 2 d u / w behind, at rest.
    const double u = (to[i] - goal_[i]) / time_step, lag = 2 * d * u / w;
    const double x = position_[i] - (goal_[i] - lag), v = velocity_[i] - u;
    position_[i] = to[i] - lag + decay.a * x + decay.b * v;
    velocity_[i] = u + decay.c * x + decay.e * v;
    goal_[i] = to[i];
  }
}

void SpringFollower::HoldAt(Vec3 position) {
  const double at[3] = {position.x, position.y, position.z};
  double out[3], length2 = 0, along = 0;
  for (int i = 0; i < 3; ++i) {
    out[i] = position_[i] - at[i];
    length2 += out[i] * out[i];
    along += out[i] * velocity_[i];
    position_[i] = at[i];
  }
  if (!(length2 > 0) || along <= 0) return;
  for (int i = 0; i < 3; ++i)
    velocity_[i] -= along / length2 * out[i];
}

}  // namespace limber
