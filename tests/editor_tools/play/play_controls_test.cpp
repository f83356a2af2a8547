// The player without a window: a pointer in pixels, a character and a camera.
#include "viewer/play_controls.h"

#include "core/vector.h"
#include "play_rigs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::viewer {
namespace {

constexpr float kWidth = 800, kHeight = 600;

float Distance(Vec3 a, Vec3 b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

class PlayControlsTest : public testing::Test {
 protected:
  void Load(const std::shared_ptr<const Rig>& rig) {
    Result<PlayCharacter> character = PlayCharacter::Create(rig, {});
    ASSERT_TRUE(character.ok()) << character.status().message();
    character_ = std::make_unique<PlayCharacter>(std::move(*character));
    controls_ = std::make_unique<PlayControls>(character_.get(), kWidth, kHeight);
    Settle();
  }

  void Settle() {
    for (int i = 0; i < 200; ++i)
      ASSERT_TRUE(character_->Step().ok());
  }

  int Handle(const char* name) const { return character_->rig().FindHandle(name); }

  Vec3 Position(int handle) const {
    return character_->handle_positions()[static_cast<size_t>(handle)];
  }

  std::array<float, 3> OnScreen(Vec3 point) const {
    return controls_->camera().Project(point, kWidth, kHeight);
  }

  void Press(float x, float y, PointerButton button = PointerButton::kLeft) {
    controls_->PointerMoved(x, y);
    ASSERT_TRUE(controls_->ButtonPressed(button, false, false).ok());
  }

  void PressHandle(const char* name, float beside = 0) {
    const std::array<float, 3> dot = OnScreen(Position(Handle(name)));
    Press(dot[0] + beside, dot[1]);
  }

  std::unique_ptr<PlayCharacter> character_;
  std::unique_ptr<PlayControls> controls_;
};

TEST_F(PlayControlsTest, DraggedDot_FollowsThePointer) {
  Load(test::BakeCylinder());
  const int top = Handle("top"), bottom = Handle("bottom");
  const Vec3 bottom_before = Position(bottom);
  const std::array<float, 3> before = OnScreen(Position(top));
  PressHandle("top", 5);  // caught off its middle
  EXPECT_EQ(controls_->action(), PointerAction::kMoveHandle);
  EXPECT_EQ(controls_->grabbed_handle(), top);
  EXPECT_NEAR(OnScreen(Position(top))[0], before[0], 0.01f) << "a press alone moves nothing";
  controls_->PointerMoved(before[0] + 5 + 90, before[1] + 40);
  const std::array<float, 3> after = OnScreen(Position(top));
  EXPECT_NEAR(after[0], before[0] + 90, 0.01f);
  EXPECT_NEAR(after[1], before[1] + 40, 0.01f);
  EXPECT_EQ(Position(bottom), bottom_before);
  controls_->ButtonReleased(PointerButton::kLeft);
  EXPECT_EQ(controls_->grabbed_handle(), -1);
  EXPECT_EQ(controls_->selected_handle(), top);
  controls_->PointerMoved(10, 10);
  EXPECT_NEAR(OnScreen(Position(top))[0], before[0] + 90, 0.01f) << "released";
}

TEST_F(PlayControlsTest, DraggedDot_TheSkinComesAlong) {
  Load(test::BakeCylinder());
  const int top = Handle("top");
  const uint32_t vertex = character_->rig().tables().handles[static_cast<size_t>(top)].vertex;
  PressHandle("top");
  const std::array<float, 3> before = OnScreen(Position(top));
  for (int i = 1; i <= 20; ++i) {
    controls_->PointerMoved(before[0] - 6.0f * static_cast<float>(i),
                            before[1] + 2.0f * static_cast<float>(i));
    ASSERT_TRUE(character_->Step().ok());
  }
  Settle();
  const Result<std::span<const Vec3>> skin = character_->SolvePositions();
  ASSERT_TRUE(skin.ok());
  EXPECT_LT(Distance((*skin)[vertex], Position(top)), 1e-4f * character_->rig().diagonal());
}

TEST_F(PlayControlsTest, DraggedSkin_FollowsThePointerAndSpringsBack) {
  Load(test::BakeCylinder());
  ASSERT_TRUE(controls_->KeyPressed(PlayKey::kToggleDots).ok());
  const Vec3 top = Position(Handle("top")), bottom = Position(Handle("bottom"));
  const auto vertex_under = [&](float x, float y) {
    const Result<std::span<const Vec3>> skin = character_->SolvePositions();
    size_t nearest = 0;
    float least = 1e9f;
    for (size_t v = 0; v < skin->size(); ++v) {
      const std::array<float, 3> at = OnScreen((*skin)[v]);
      const float off = std::hypot(at[0] - x, at[1] - y) + 1000 * at[2];  // the front one
      if (off < least) {
        least = off;
        nearest = v;
      }
    }
    return nearest;
  };
  const std::array<float, 3> skin = OnScreen({0, 1.2f, 0});
  const size_t vertex = vertex_under(skin[0], skin[1]);
  const Vec3 rest = (*character_->SolvePositions())[vertex];
  const std::array<float, 3> before = OnScreen(rest);
  Press(skin[0], skin[1]);
  EXPECT_EQ(controls_->action(), PointerAction::kMoveSkin);
  EXPECT_EQ(controls_->grabbed_handle(), -1);
  for (int i = 1; i <= 20; ++i) {
    controls_->PointerMoved(skin[0] + 3.0f * static_cast<float>(i), skin[1]);
    ASSERT_TRUE(character_->Step().ok());
  }
  Settle();
  const std::array<float, 3> after = OnScreen((*character_->SolvePositions())[vertex]);
  EXPECT_NEAR(after[0] - before[0], 60, 15);
  EXPECT_NEAR(after[1] - before[1], 0, 15);
  EXPECT_EQ(Position(Handle("top")), top) << "handles stay where they are";
  EXPECT_EQ(Position(Handle("bottom")), bottom);
  controls_->ButtonReleased(PointerButton::kLeft);
  Settle();
  Settle();
  // Held at two points of its axis the cylinder may have turned about it.
  const Vec3 back = (*character_->SolvePositions())[vertex];
  EXPECT_NEAR(back.y, rest.y, 0.02f);
  EXPECT_NEAR(std::hypot(back.x, back.z), std::hypot(rest.x, rest.z), 0.02f);
}

TEST_F(PlayControlsTest, P_LetsAHandleGoAndPinsItWhereItIs) {
  Load(test::BakeCylinder());
  const int top = Handle("top"), bottom = Handle("bottom");
  const auto press_over = [&](int handle) {
    const std::array<float, 3> dot = OnScreen(Position(handle));
    controls_->PointerMoved(dot[0], dot[1]);
    ASSERT_TRUE(controls_->UpdateHover().ok());
    ASSERT_TRUE(controls_->KeyPressed(PlayKey::kTogglePin).ok());
    Settle();
  };
  press_over(top);
  EXPECT_FALSE(character_->pinned(top));
  press_over(bottom);
  EXPECT_TRUE(character_->pinned(bottom)) << "the last one stays";
  character_->MoveHandle(bottom, {0.5f, 0, 0});
  Settle();
  const Vec3 along = Position(top);
  EXPECT_NEAR(along.x, 0.5f, 0.05f) << "the character hangs on one point";
  press_over(top);
  EXPECT_TRUE(character_->pinned(top));
  EXPECT_LT(Distance(Position(top), along), 1e-4f);
  ASSERT_TRUE(controls_->KeyPressed(PlayKey::kReset).ok());
  EXPECT_TRUE(character_->pinned(top) && character_->pinned(bottom));
}

// A character baked in format version 1, whose skin cannot be held.
TEST_F(PlayControlsTest, DraggedSkinOfAnOldBake_MovesTheNearestPinnedHandleAsFar) {
  Load(test::BakeCylinderOfVersion1());
  ASSERT_TRUE(controls_->KeyPressed(PlayKey::kToggleDots).ok());
  const int top = Handle("top");
  const Vec3 target = Position(top);
  const std::array<float, 3> skin = OnScreen({0, 1.7f, 0});
  Press(skin[0], skin[1]);
  EXPECT_EQ(controls_->action(), PointerAction::kMoveSkin);
  EXPECT_EQ(controls_->grabbed_handle(), top);
  controls_->PointerMoved(skin[0] + 50, skin[1]);
  EXPECT_GT(Distance(Position(top), target), 0.05f);
  controls_->PointerMoved(skin[0], skin[1]);
  EXPECT_LT(Distance(Position(top), target), 1e-5f);
}

TEST_F(PlayControlsTest, FreeHandle_CannotBeMoved) {
  Load(test::BakeCylinder());
  PressHandle("middle");
  EXPECT_EQ(controls_->action(), PointerAction::kNone);
  EXPECT_EQ(controls_->selected_handle(), -1);
}

TEST_F(PlayControlsTest, Background_OrbitsAndTheCharacterStays) {
  Load(test::BakeCylinder());
  const Vec3 eye = controls_->camera().eye(), top = Position(Handle("top"));
  Press(15, 15);
  EXPECT_EQ(controls_->action(), PointerAction::kOrbit);
  controls_->PointerMoved(115, 15);
  EXPECT_GT(Distance(controls_->camera().eye(), eye), 0.2f);
  EXPECT_EQ(Position(Handle("top")), top);
  controls_->PointerMoved(15, 15);
  EXPECT_LT(Distance(controls_->camera().eye(), eye), 1e-4f) << "back where it was";
}

TEST_F(PlayControlsTest, PanAndZoom_MoveThePicture) {
  Load(test::BakeCylinder());
  const Vec3 top = Position(Handle("top")), bottom = Position(Handle("bottom"));
  const std::array<float, 3> before = OnScreen(Position(Handle("middle")));
  Press(300, 300, PointerButton::kMiddle);
  controls_->PointerMoved(340, 280);
  const std::array<float, 3> after = OnScreen(Position(Handle("middle")));
  EXPECT_NEAR(after[0] - before[0], 40, 5);
  EXPECT_NEAR(after[1] - before[1], -20, 5);
  controls_->ButtonReleased(PointerButton::kMiddle);
  const float height = OnScreen(bottom)[1] - OnScreen(top)[1];
  controls_->Scrolled(3);
  EXPECT_GT(OnScreen(bottom)[1] - OnScreen(top)[1], 1.2f * height);
  controls_->Scrolled(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(std::isfinite(controls_->camera().distance()));
}

TEST_F(PlayControlsTest, Planar_SeenFaceOnAndNeverOrbited) {
  Load(test::BakeSquare());
  ASSERT_TRUE(character_->planar());
  const auto forward = [this] {
    return controls_->camera().PixelRay(kWidth / 2, kHeight / 2, kWidth, kHeight).direction;
  };
  EXPECT_NEAR(forward().z, -1, 1e-6f);
  for (const PointerButton button : {PointerButton::kLeft, PointerButton::kRight}) {
    Press(15, 15, button);
    controls_->PointerMoved(200, 90);
    controls_->ButtonReleased(button);
    EXPECT_NEAR(forward().z, -1, 1e-6f);
  }
  PressHandle("right");
  controls_->PointerMoved(500, 100);
  EXPECT_NEAR(Position(Handle("right")).z, 0, 1e-5f) << "a drag stays in the character's plane";
}

TEST_F(PlayControlsTest, Hover_FindsTheDotUnderThePointer) {
  Load(test::BakeCylinder());
  const std::array<float, 3> dot = OnScreen(Position(Handle("top")));
  const auto hover_at = [this](float x, float y) {
    controls_->PointerMoved(x, y);
    EXPECT_TRUE(controls_->UpdateHover().ok());
    return controls_->hovered_handle();
  };
  EXPECT_EQ(hover_at(dot[0] + DotReachPixels(kHeight) - 1, dot[1]), Handle("top"));
  EXPECT_EQ(hover_at(dot[0], dot[1] + DotReachPixels(kHeight) + 1.5f), -1);
  EXPECT_EQ(hover_at(dot[0], dot[1]), Handle("top"));
  controls_->PointerLeft();
  EXPECT_TRUE(controls_->UpdateHover().ok());
  EXPECT_EQ(controls_->hovered_handle(), -1);
  ASSERT_TRUE(controls_->KeyPressed(PlayKey::kToggleDots).ok());
  EXPECT_EQ(hover_at(dot[0], dot[1]), -1) << "hidden dots are not there";
}

TEST_F(PlayControlsTest, Reset_BringsTheRestPoseBack) {
  Load(test::BakeCylinder());
  const Result<std::span<const Vec3>> rest = character_->SolvePositions();
  ASSERT_TRUE(rest.ok());
  const Vector<Vec3> before(rest->begin(), rest->end());
  PressHandle("top");
  controls_->PointerMoved(650, 420);
  Settle();
  ASSERT_TRUE(controls_->KeyPressed(PlayKey::kReset).ok());
  EXPECT_EQ(controls_->action(), PointerAction::kNone) << "a reset ends the drag";
  Settle();
  const Result<std::span<const Vec3>> after = character_->SolvePositions();
  ASSERT_TRUE(after.ok());
  for (size_t v = 0; v < before.size(); ++v) {
    EXPECT_LT(Distance(before[v], (*after)[v]), 1e-4f * character_->rig().diagonal());
  }
}

TEST_F(PlayControlsTest, Frame_BringsADraggedCharacterIntoThePicture) {
  Load(test::BakeCylinder());
  character_->MoveHandle(Handle("top"), {20, 30, 0});
  Settle();
  const auto in_picture = [this](Vec3 point) {
    const std::array<float, 3> at = OnScreen(point);
    return at[0] > 0 && at[0] < kWidth && at[1] > 0 && at[1] < kHeight && at[2] > 0 && at[2] < 1;
  };
  EXPECT_FALSE(in_picture(Position(Handle("top"))));
  ASSERT_TRUE(controls_->KeyPressed(PlayKey::kFrame).ok());
  EXPECT_TRUE(in_picture(Position(Handle("top"))));
  EXPECT_TRUE(in_picture(Position(Handle("bottom"))));
}

TEST_F(PlayControlsTest, Sticks_MoveTwoHandlesAlongTheImage) {
  Load(test::BakeCylinder());
  const int bottom = Handle("bottom"), top = Handle("top");
  const std::array<float, 3> bottom_before = OnScreen(Position(bottom));
  const std::array<float, 3> top_before = OnScreen(Position(top));
  controls_->SticksHeld({.left_x = 1, .right_y = -1}, 0.05);
  EXPECT_GT(OnScreen(Position(bottom))[0], bottom_before[0] + 3);
  EXPECT_NEAR(OnScreen(Position(bottom))[1], bottom_before[1], 1);
  EXPECT_LT(OnScreen(Position(top))[1], top_before[1] - 3) << "up is up";
  EXPECT_NEAR(OnScreen(Position(top))[0], top_before[0], 1);
}

TEST_F(PlayControlsTest, Change_ReportedOncePerChange) {
  Load(test::BakeCylinder());
  EXPECT_TRUE(controls_->TakeChange()) << "the first picture";
  EXPECT_FALSE(controls_->TakeChange());
  controls_->PointerMoved(15, 15);
  EXPECT_TRUE(controls_->UpdateHover().ok());
  EXPECT_FALSE(controls_->TakeChange()) << "a pointer over nothing changes nothing";
  controls_->Scrolled(1);
  EXPECT_TRUE(controls_->TakeChange());
  controls_->SticksHeld({}, 0.016);
  EXPECT_FALSE(controls_->TakeChange());
}

TEST_F(PlayControlsTest, TargetsThrownFarAway_CanBeBroughtBack) {
  Load(test::BakeCylinder());
  const int top = Handle("top");
  const Vec3 rest = Position(top);
  character_->MoveHandle(top, {1e6f, 0, 0});
  ASSERT_TRUE(character_->Step().ok());
  controls_->PointerMoved(400, 300);
  EXPECT_TRUE(controls_->UpdateHover().ok());
  character_->MoveHandle(top, {std::numeric_limits<float>::quiet_NaN(), 0, 0});
  EXPECT_EQ(Position(top), (Vec3{1e6f, 0, 0})) << "refused";
  ASSERT_TRUE(controls_->KeyPressed(PlayKey::kReset).ok());
  Settle();
  EXPECT_LT(Distance(Position(top), rest), 1e-5f);
  const std::array<float, 3> dot = OnScreen(Position(top));
  controls_->PointerMoved(dot[0], dot[1]);
  EXPECT_TRUE(controls_->UpdateHover().ok());
  EXPECT_EQ(controls_->hovered_handle(), top);
}

}  // namespace
}  // namespace limber::viewer
