// The spring against a fine numerical integration, and against itself at other frame rates.
#include "drive/spring_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace limber {
namespace {

Vec3 GoalAt(double time) {  // straight from tenth to tenth of a second
  const double whole = std::floor(time * 10) / 10, part = time * 10 - std::floor(time * 10);
  const auto knot = [](double t) { return std::sin(7 * t) + (t > 1 ? 2 : 0); };
  const double x = (1 - part) * knot(whole) + part * knot(whole + 0.1);
  return {static_cast<float>(x), static_cast<float>(-2 * x), 0.5f};
}

// The equation of motion in steps of a microsecond (explicit midpoint).
double Integrate(const SpringOptions& options, double seconds) {
  const double w = 2 * std::numbers::pi * options.frequency, step = 1e-5;
  double x = GoalAt(0).x, v = 0;
  const auto pull = [&](double at, double speed, double t) {
    return w * w * (GoalAt(t).x - at) - 2 * options.damping * w * speed;
  };
  for (int i = 0; i < static_cast<int>(seconds / step + 0.5); ++i) {
    const double t = i * step, middle_x = x + step / 2 * v;
    const double middle_v = v + step / 2 * pull(x, v, t);
    x += step * middle_v;
    v += step * pull(middle_x, middle_v, t + step / 2);
  }
  return x;
}

double Follow(const SpringOptions& options, double seconds, int steps) {
  SpringFollower follower;
  follower.Reset(GoalAt(0));
  for (int i = 1; i <= steps; ++i)
    follower.Step(options, GoalAt(seconds * i / steps), seconds / steps);
  return follower.position().x;
}

TEST(SpringFollower, AnyDamping_IsTheEquationOfMotion) {
  for (const double damping : {0.0, 0.3, 0.999, 0.99999999, 1.0, 1.0005, 1.002, 3.0}) {
    const SpringOptions options{1.5, damping};
    EXPECT_NEAR(Follow(options, 1.5, 15), Integrate(options, 1.5), 2e-4) << damping;
  }
}

TEST(SpringFollower, AnyFrameRate_GivesTheSameMotion) {
  for (const double damping : {0.2, 1.0, 2.0}) {
    const SpringOptions options{4, damping};
    const double once = Follow(options, 2, 20);
    for (const int steps : {40, 60, 2000})
      EXPECT_NEAR(Follow(options, 2, steps), once, 1e-6) << damping << ' ' << steps;
  }
}

TEST(SpringFollower, CriticalDamping_NeverOvershoots) {
  SpringFollower follower;
  follower.Reset({0, 0, 0});
  follower.Step({3, 1}, {1, 0, 0}, 1e-9);  // a jump
  float last = 0;
  for (int i = 0; i < 600; ++i) {
    follower.Step({3, 1}, {1, 0, 0}, 1.0 / 60);
    EXPECT_GE(follower.position().x, last);
    EXPECT_LE(follower.position().x, 1);
    last = follower.position().x;
  }
  EXPECT_NEAR(last, 1, 1e-6);
}

TEST(SpringFollower, ExtremeNumbers_StayFinite) {
  for (const double damping : {0.0, 1.0, 1e4}) {
    for (const double frequency : {1e-6, 1e4}) {
      for (const double step : {1e-9, 1e4}) {
        SpringFollower follower;
        follower.Reset({1, 2, 3});
        for (int i = 0; i < 50; ++i)
          follower.Step({frequency, damping}, {5, -7, 9}, step);
        EXPECT_TRUE(std::isfinite(follower.position().x)) << damping << frequency << step;
        EXPECT_LT(std::abs(follower.position().y), 1e3);
      }
    }
  }
}

TEST(SpringFollower, HeldBack_KeepsTheSpeedAlongTheBound) {
  SpringFollower follower;
  follower.Reset({0, 0, 0});
  const SpringOptions options{1, 0.5};
  for (int i = 0; i < 10; ++i)
    follower.Step(options, {1, 1, 0}, 0.02);
  const Vec3 before = follower.position();
  follower.HoldAt({before.x - 0.1f, before.y, before.z});
  follower.Step(options, {1, 1, 0}, 1e-6);
  const Vec3 after = follower.position();
  EXPECT_NEAR(after.x, before.x - 0.1f, 1e-5) << "it would have gone on in x";
  EXPECT_GT(after.y - before.y, 1e-7);
}

}  // namespace
}  // namespace limber
