// What the player's hands mean: pure decisions from buttons, keys and sticks, without a window.
#pragma once

#include "core/vec3.h"

#include <array>
#include <span>

namespace limber::viewer {

enum class PointerButton { kLeft, kMiddle, kRight };

// What lies under the pointer when a button goes down.
enum class PointerTarget { kBackground, kSkin, kHandle };

enum class PointerAction { kNone, kMoveHandle, kMoveSkin, kOrbit, kPan };

// Left on a dot moves it, left on the skin moves that, left elsewhere orbits; right, or Alt with
// left, orbits wherever it is; middle, or Shift with right, pans. A planar character is seen face
// on and never orbited: it pans instead.
struct PointerPress {
  PointerButton button = PointerButton::kLeft;
  bool alt = false, shift = false;
  PointerTarget target = PointerTarget::kBackground;
};

PointerAction ChooseAction(const PointerPress& press, bool planar);

// The two sticks of a gamepad as the system gives them: right and down are positive, within -1..1.
struct GamepadSticks {
  float left_x = 0, left_y = 0, right_x = 0, right_y = 0;
};

// The image plane in mesh space: unit vectors to the right and upwards.
struct ImageAxes {
  Vec3 right = {1, 0, 0}, up = {0, 1, 0};
};

// How far a stick at (x, y) carries its handle in `seconds`: none within a dead zone of 0.15, then
// with the square of the push up to one `size` (the character's diagonal) a second, the same in all
// directions. `seconds` above 0.1 count as 0.1 (after a pause nothing leaps). Not finite: none.
Vec3 StickMotion(float x, float y, const ImageAxes& axes, float size, double seconds);

// The handles that the left and the right stick move: the selected one, when it is pinned, and the
// first other pinned ones in order; -1 where there are too few. `selected` may be -1.
std::array<int, 2> StickHandles(int selected, std::span<const bool> pinned);

}  // namespace limber::viewer
