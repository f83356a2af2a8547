#include "viewer/play_input.h"

#include <algorithm>
#include <cmath>

namespace limber::viewer {

PointerAction ChooseAction(const PointerPress& press, bool planar) {
  const PointerAction turn = planar ? PointerAction::kPan : PointerAction::kOrbit;
  switch (press.button) {
    case PointerButton::kMiddle:
      return PointerAction::kPan;
    case PointerButton::kRight:
      return press.shift ? PointerAction::kPan : turn;
    case PointerButton::kLeft:
      break;
  }
  if (press.alt) return turn;
  switch (press.target) {
    case PointerTarget::kHandle:
      return PointerAction::kMoveHandle;
    case PointerTarget::kSkin:
      return PointerAction::kMoveSkin;
    case PointerTarget::kBackground:
      break;
  }
  return turn;
}

Vec3 StickMotion(float x, float y, const ImageAxes& axes, float size, double seconds) {
  constexpr double kDeadZone = 0.15;
  constexpr double kLongestStep = 0.1;  // seconds
  const double push = std::hypot(double{x}, double{y});
  if (!std::isfinite(push) || push <= kDeadZone) return {};
  const double beyond = (std::min(push, 1.0) - kDeadZone) / (1 - kDeadZone);
  const double way = beyond * beyond * size * std::clamp(seconds, 0.0, kLongestStep);
  const double right = way * x / push, up = -way * y / push;
  Vec3 motion;
  for (int i = 0; i < 3; ++i) {
    motion[i] = static_cast<float>(right * axes.right[i] + up * axes.up[i]);
  }
  return motion;
}

std::array<int, 2> StickHandles(int selected, std::span<const bool> pinned) {
  std::array<int, 2> handles = {-1, -1};
  const auto count = static_cast<int>(pinned.size());
  size_t found = 0;
  if (selected >= 0 && selected < count && pinned[static_cast<size_t>(selected)]) {
    handles[found++] = selected;
  }
  for (int i = 0; i < count && found < handles.size(); ++i) {
    if (i != handles[0] && pinned[static_cast<size_t>(i)]) handles[found++] = i;
  }
  return handles;
}

}  // namespace limber::viewer
