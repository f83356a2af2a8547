#include "viewer/play_input.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace limber::viewer {
namespace {

TEST(ChooseAction, EveryButtonHasItsMeaning) {
  using enum PointerButton;
  using enum PointerTarget;
  using enum PointerAction;
  EXPECT_EQ(ChooseAction({.target = kHandle}, false), kMoveHandle);
  EXPECT_EQ(ChooseAction({.target = kSkin}, false), kMoveSkin);
  EXPECT_EQ(ChooseAction({.target = kBackground}, false), kOrbit);
  for (const PointerTarget target : {kBackground, kSkin, kHandle}) {
    EXPECT_EQ(ChooseAction({.alt = true, .target = target}, false), kOrbit);
    EXPECT_EQ(ChooseAction({.button = kRight, .target = target}, false), kOrbit);
    EXPECT_EQ(ChooseAction({.button = kRight, .shift = true, .target = target}, false), kPan);
    EXPECT_EQ(ChooseAction({.button = kMiddle, .target = target}, false), kPan);
  }
}

TEST(ChooseAction, PlanarCharacter_IsNeverOrbited) {
  using enum PointerTarget;
  for (const auto button : {PointerButton::kLeft, PointerButton::kMiddle, PointerButton::kRight}) {
    for (const auto target : {kBackground, kSkin, kHandle}) {
      for (int keys = 0; keys < 4; ++keys) {
        const bool alt = (keys & 1) != 0, shift = (keys & 2) != 0;
        EXPECT_NE(ChooseAction({button, alt, shift, target}, true), PointerAction::kOrbit);
      }
    }
  }
  EXPECT_EQ(ChooseAction({.target = kHandle}, true), PointerAction::kMoveHandle);
}

double Length(Vec3 v) {
  return std::sqrt(double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z);
}

TEST(StickMotion, DeadZoneThenContinuousGrowth) {
  const ImageAxes axes;
  EXPECT_EQ(StickMotion(0.1f, -0.1f, axes, 2, 0.016), Vec3{});
  double last = 0;
  for (int i = 0; i <= 100; ++i) {
    const float push = static_cast<float>(i) / 100;
    const double way = Length(StickMotion(push, 0, axes, 2, 0.016));
    EXPECT_GE(way, last);
    EXPECT_LT(way - last, 0.001) << "a leap at " << i;
    last = way;
  }
  EXPECT_NEAR(last, 2 * 0.016, 1e-6) << "one size a second at full push";
}

TEST(StickMotion, SameInAllDirectionsAndInTheImagePlane) {
  const ImageAxes axes = {{0, 0, -1}, {0, 1, 0}};
  for (int degrees = 0; degrees < 360; degrees += 15) {
    const double angle = degrees * 3.14159265358979 / 180;
    const auto x = static_cast<float>(0.8 * std::cos(angle));
    const auto y = static_cast<float>(0.8 * std::sin(angle));
    const Vec3 motion = StickMotion(x, y, axes, 1, 0.05);
    EXPECT_NEAR(Length(motion), Length(StickMotion(0.8f, 0, axes, 1, 0.05)), 1e-6);
    EXPECT_EQ(motion.x, 0);
    EXPECT_NEAR(-motion.z, Length(motion) * std::cos(angle), 1e-6);
    EXPECT_NEAR(motion.y, -Length(motion) * std::sin(angle), 1e-6) << "a stick pushed up is minus";
  }
  // A square gate reports corners beyond one: no faster than straight on.
  EXPECT_NEAR(Length(StickMotion(1, 1, axes, 1, 0.05)), 0.05, 1e-6);
}

TEST(StickMotion, PauseOrNonsense_NoLeap) {
  const ImageAxes axes;
  EXPECT_EQ(StickMotion(1, 0, axes, 1, 30), StickMotion(1, 0, axes, 1, 0.1));
  EXPECT_EQ(StickMotion(1, 0, axes, 1, -5), Vec3{});
  EXPECT_EQ(StickMotion(std::numeric_limits<float>::quiet_NaN(), 1, axes, 1, 0.1), Vec3{});
}

TEST(StickMotion, FrameRateDoesNotMatter) {
  const ImageAxes axes;
  double coarse = 0, fine = 0;
  for (int i = 0; i < 30; ++i)
    coarse += StickMotion(0.7f, 0, axes, 1, 1.0 / 30).x;
  for (int i = 0; i < 240; ++i)
    fine += StickMotion(0.7f, 0, axes, 1, 1.0 / 240).x;
  EXPECT_NEAR(coarse, fine, 1e-5);
}

TEST(StickHandles, SelectedFirstThenPinnedOnesInOrder) {
  const std::array<bool, 4> pinned = {false, true, true, true};
  EXPECT_EQ(StickHandles(-1, pinned), (std::array{1, 2}));
  EXPECT_EQ(StickHandles(3, pinned), (std::array{3, 1}));
  EXPECT_EQ(StickHandles(0, pinned), (std::array{1, 2})) << "a free handle cannot be moved";
  EXPECT_EQ(StickHandles(9, pinned), (std::array{1, 2}));
  EXPECT_EQ(StickHandles(-1, std::array{true}), (std::array{0, -1}));
  EXPECT_EQ(StickHandles(0, std::span<const bool>()), (std::array{-1, -1}));
}

}  // namespace
}  // namespace limber::viewer
