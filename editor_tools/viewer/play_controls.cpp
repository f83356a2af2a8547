#include "viewer/play_controls.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace limber::viewer {
namespace {

constexpr float kRadiansPerPixel = 0.008f;
constexpr float kZoomPerNotch = 0.88f;

float AspectOf(float width, float height) {
  return std::max(width, 1.0f) / std::max(height, 1.0f);
}

OrbitCamera FrameBounds(const PlayCharacter& character, const Bounds& bounds, float aspect) {
  return character.planar() ? OrbitCamera::FrameFlat(bounds, character.rig().tables().space, aspect)
                            : OrbitCamera::Frame(bounds, aspect);
}

// Half way between the rest shape, which is seen first, and all that the examples reach to.
Bounds FirstView(const Rig& rig) {
  const Bounds rest = ShapeBounds(rig.mesh(), rig.tables().space, 0);
  Bounds view = ShapeBounds(rig.mesh(), rig.tables().space);
  for (int axis = 0; axis < 3; ++axis) {
    view.low[axis] = (view.low[axis] + rest.low[axis]) / 2;
    view.high[axis] = (view.high[axis] + rest.high[axis]) / 2;
  }
  return view;
}

Vec3 Minus(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

float Length(Vec3 v) {
  return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

Vec3 Normalized(Vec3 v) {
  const float length = Length(v);
  return {v.x / length, v.y / length, v.z / length};
}

}  // namespace

float DotReachPixels(float picture_height) {
  return std::max(10.0f, picture_height / 95 + 5);
}

PlayControls::PlayControls(PlayCharacter* character, float width, float height)
    : character_(character),
      camera_(FrameBounds(*character, FirstView(character->rig()), AspectOf(width, height))),
      width_(width),
      height_(height) {}

PickRay PlayControls::PointerRay() const {
  const Ray ray = camera_.PixelRay(pointer_x_, pointer_y_, width_, height_);
  PickRay result;
  result.origin = ray.origin;
  result.direction = ray.direction;
  return result;
}

Vec3 PlayControls::CameraForward() const {
  return camera_.PixelRay(width_ / 2, height_ / 2, width_, height_).direction;
}

// Rays through opposite edges of the picture have equal length and differ along the image only.
ImageAxes PlayControls::CameraAxes() const {
  const auto direction = [this](float x, float y) {
    return camera_.PixelRay(x * width_, y * height_, width_, height_).direction;
  };
  ImageAxes axes;
  axes.right = Normalized(Minus(direction(1, 0.5f), direction(0, 0.5f)));
  axes.up = Normalized(Minus(direction(0.5f, 0), direction(0.5f, 1)));
  return axes;
}

HandlePickOptions PlayControls::DotReach() const {
  const Vec3 forward = CameraForward();
  const Vec3 beside =
      camera_.PixelRay(width_ / 2 + DotReachPixels(height_), height_ / 2, width_, height_)
          .direction;
  const float cosine = forward.x * beside.x + forward.y * beside.y + forward.z * beside.z;
  HandlePickOptions reach;
  reach.cone_tangent = std::sqrt(std::max(0.0f, 1 - cosine * cosine)) / std::max(cosine, 1e-3f);
  // Dots are drawn over the character, so one that is behind it can be seen and meant.
  reach.occlusion = false;
  return reach;
}

void PlayControls::PointerMoved(float x, float y) {
  const float dx = x - pointer_x_, dy = y - pointer_y_;
  pointer_x_ = x;
  pointer_y_ = y;
  pointer_inside_ = true;
  switch (action_) {
    case PointerAction::kNone:
      break;
    case PointerAction::kMoveHandle:
    case PointerAction::kMoveSkin:
      if (const std::optional<Vec3> position = drag_->PositionAt(PointerRay())) {
        if (skin_grabbed_) {
          character_->MoveGrab(*position);
        } else {
          character_->MoveHandle(grabbed_, *position);
        }
      }
      changed_ = true;
      break;
    case PointerAction::kOrbit:
      camera_.Orbit(-dx * kRadiansPerPixel, dy * kRadiansPerPixel);
      changed_ = true;
      break;
    case PointerAction::kPan:
      camera_.Pan(dx, dy, height_);
      changed_ = true;
      break;
  }
}

void PlayControls::PointerLeft() {
  pointer_inside_ = false;
}

Status PlayControls::ButtonPressed(PointerButton button, bool alt, bool shift) {
  ButtonReleased(button_);
  const Result<PointerHit> hit = character_->Pick(PointerRay(), DotReach(), dots_shown_);
  if (!hit.ok()) return hit.status();
  action_ = ChooseAction({button, alt, shift, hit->target}, character_->planar());
  button_ = button;
  if (action_ == PointerAction::kMoveHandle || action_ == PointerAction::kMoveSkin) {
    BeginMove(*hit);
  }
  changed_ = true;
  return {};
}

void PlayControls::BeginMove(const PointerHit& hit) {
  drag_.reset();
  if (action_ == PointerAction::kMoveSkin && character_->GrabSkin(hit.skin)) {
    skin_grabbed_ = true;
    drag_ = ViewPlaneDrag::Begin(PointerRay(), hit.point, hit.point, CameraForward());
    if (!drag_) ButtonReleased(button_);
    return;
  }
  if (hit.handle >= 0 && character_->pinned(hit.handle)) {
    const Vec3 target = character_->handle_positions()[static_cast<size_t>(hit.handle)];
    drag_ = ViewPlaneDrag::Begin(PointerRay(), hit.point, target, CameraForward());
  }
  if (!drag_) {
    action_ = PointerAction::kNone;
    return;
  }
  grabbed_ = selected_ = hit.handle;
}

void PlayControls::ButtonReleased(PointerButton button) {
  if (action_ == PointerAction::kNone || button != button_) return;
  action_ = PointerAction::kNone;
  grabbed_ = -1;
  if (skin_grabbed_) character_->ReleaseGrab();
  skin_grabbed_ = false;
  drag_.reset();
  changed_ = true;
}

void PlayControls::Scrolled(float notches) {
  if (!std::isfinite(notches)) return;
  camera_.Zoom(std::pow(kZoomPerNotch, std::clamp(notches, -20.0f, 20.0f)));
  changed_ = true;
}

Status PlayControls::KeyPressed(PlayKey key) {
  changed_ = true;
  switch (key) {
    case PlayKey::kReset:
      ButtonReleased(button_);
      character_->Reset();
      return {};
    case PlayKey::kFrame:
      return FramePose();
    case PlayKey::kToggleDots:
      dots_shown_ = !dots_shown_;
      return {};
    case PlayKey::kTogglePin:
      if (hovered_ >= 0) character_->TogglePin(hovered_);
      return {};
  }
  return {};
}

Status PlayControls::FramePose() {
  const Result<std::span<const Vec3>> positions = character_->SolvePositions();
  if (!positions.ok()) return positions.status();
  Bounds bounds = {positions->front(), positions->front()};
  for (const Vec3& p : *positions) {
    for (int axis = 0; axis < 3; ++axis) {
      bounds.low[axis] = std::min(bounds.low[axis], p[axis]);
      bounds.high[axis] = std::max(bounds.high[axis], p[axis]);
    }
  }
  camera_ = FrameBounds(*character_, bounds, AspectOf(width_, height_));
  return {};
}

void PlayControls::SticksHeld(const GamepadSticks& sticks, double seconds) {
  const std::array<int, 2> handles = StickHandles(selected_, character_->pinned_handles());
  const ImageAxes axes = CameraAxes();
  const float size = character_->rig().diagonal();
  const Vec3 motions[2] = {StickMotion(sticks.left_x, sticks.left_y, axes, size, seconds),
                           StickMotion(sticks.right_x, sticks.right_y, axes, size, seconds)};
  for (size_t i = 0; i < 2; ++i) {
    if (handles[i] < 0 || motions[i] == Vec3{}) continue;
    Vec3 target = character_->handle_positions()[static_cast<size_t>(handles[i])];
    for (int axis = 0; axis < 3; ++axis)
      target[axis] += motions[i][axis];
    character_->MoveHandle(handles[i], target);
    changed_ = true;
  }
}

void PlayControls::Resized(float width, float height) {
  width_ = width;
  height_ = height;
  camera_.set_aspect(AspectOf(width, height));
  changed_ = true;
}

Status PlayControls::UpdateHover() {
  int now = -1;
  if (action_ == PointerAction::kNone && pointer_inside_ && dots_shown_) {
    const Result<PointerHit> hit = character_->Pick(PointerRay(), DotReach(), true);
    if (!hit.ok()) return hit.status();
    if (hit->target == PointerTarget::kHandle) now = hit->handle;
  }
  if (now != hovered_) changed_ = true;
  hovered_ = now;
  return {};
}

bool PlayControls::TakeChange() {
  return std::exchange(changed_, false);
}

}  // namespace limber::viewer
