// From the pointer, the keys and the sticks to the character and the camera; knows no window.
#pragma once

#include "core/status.h"
#include "viewer/camera.h"
#include "viewer/play_character.h"
#include "viewer/play_drag.h"
#include "viewer/play_input.h"

#include <optional>

namespace limber::viewer {

// How far from a dot's middle the pointer catches it, in pixels: a little more than its radius,
// which grows with the picture.
float DotReachPixels(float picture_height);

enum class PlayKey { kReset, kFrame, kToggleDots, kTogglePin };

class PlayControls {
 public:
  // Borrows the character. The size is that of the picture in pixels.
  PlayControls(PlayCharacter* character, float width, float height);

  // Pixels from the top left corner of the picture.
  void PointerMoved(float x, float y);
  void PointerLeft();
  // Ends a drag that is under way first: one at a time.
  Status ButtonPressed(PointerButton button, bool alt, bool shift);
  void ButtonReleased(PointerButton button);
  void Scrolled(float notches);
  Status KeyPressed(PlayKey key);
  void SticksHeld(const GamepadSticks& sticks, double seconds);
  void Resized(float width, float height);

  // Finds the dot under the pointer; once a frame, after the character's Step.
  Status UpdateHover();

  const OrbitCamera& camera() const { return camera_; }

  bool dots_shown() const { return dots_shown_; }

  int hovered_handle() const { return hovered_; }  // -1: none

  int grabbed_handle() const { return action_ == PointerAction::kNone ? -1 : grabbed_; }

  int selected_handle() const { return selected_; }  // the last that was grabbed

  PointerAction action() const { return action_; }

  // Whether the picture has to be drawn anew since the last call.
  bool TakeChange();

 private:
  PickRay PointerRay() const;
  HandlePickOptions DotReach() const;
  ImageAxes CameraAxes() const;
  Vec3 CameraForward() const;
  void BeginMove(const PointerHit& hit);
  Status FramePose();

  PlayCharacter* character_;
  OrbitCamera camera_;
  float width_, height_;
  float pointer_x_ = 0, pointer_y_ = 0;
  bool pointer_inside_ = false;
  PointerAction action_ = PointerAction::kNone;
  PointerButton button_ = PointerButton::kLeft;  // that holds the action
  std::optional<ViewPlaneDrag> drag_;
  int hovered_ = -1, grabbed_ = -1, selected_ = -1;
  bool skin_grabbed_ = false;  // the drag holds the skin itself
  bool dots_shown_ = true;
  bool changed_ = true;
};

}  // namespace limber::viewer
