// The fox's drawing; shared by the files that paint and pose it. Coordinates as in the mesh.
#pragma once

#include "generate/canvas.h"
#include "generate/curve.h"

namespace limber::content {

struct FoxModel {
  Limb tail, arm_left, arm_right;  // left and right as seen: left is x < 0
  FoxModel();

  // Signed distances of the flat shapes that the fox is put together from.
  double Head(const Vector2d& p) const;
  double Ears(const Vector2d& p) const;
  double Trunk(const Vector2d& p) const;
  double Legs(const Vector2d& p) const;
  double Arms(const Vector2d& p) const;
  double Tail(const Vector2d& p) const;
  // All of them, rounded where they meet.
  double Distance(const Vector2d& p) const;
};

// The width of the paper around the drawing, and of the mesh around the paper.
constexpr double kFoxPaper = 0.05, kFoxMargin = 0.012;

// The drawing with its paper, transparent outside.
Colour FoxColour(const FoxModel& fox, const Vector2d& p);

}  // namespace limber::content
