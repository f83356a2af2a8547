#include "generate/fox.h"

#include "generate/drag.h"
#include "generate/fox_parts.h"
#include "generate/planar_mesh.h"
#include "generate/pose.h"
#include "generate/shaping.h"
#include "generate/smooth_offsets.h"
#include "generate/space_warp.h"

#include <functional>
#include <utility>

namespace limber::content {
namespace {

constexpr int kPixels = 1024;
constexpr int kSmoothing = 10;
constexpr double kSpacing = 0.042;
// The part of the plane that the picture shows, a square.
constexpr double kLeft = -0.7, kBottom = -0.12, kSize = 2.3;

// One gesture: all of it by an amount.
struct FoxGesture {
  const char* name;
  double height;
  std::function<double(double)> girth;
  double reach;                               // of the girth, as for Swell
  double bend, jump;                          // radians to the left, upwards
  double tail_turn, tail_length;              // radians over its length, times its length at rest
  double left_turn, right_turn, arms_length;  // upwards
};

std::vector<FoxGesture> FoxGestures() {
  const auto stretch = [](double y) { return 0.82 - 0.1 * Bump(y, 0.7, 0.4); };
  const auto squash = [](double y) { return 1.35 + 0.15 * Bump(y, 0.4, 0.5); };
  const auto slim = [](double y) { return 0.93 - 0.05 * Bump(y, 0.7, 0.4); };
  const auto full = [](double) { return 1.05; };
  return {{"stretch", 1.45, stretch, 1.5, 0, 0, -0.4, 1.15, -0.35, -0.35, 1.2},
          {"squash", 0.58, squash, 1.2, 0, 0, -0.5, 1.0, 0.5, 0.5, 1.15},
          {"bend_left", 1.1, slim, 1.5, 0.9, 0, -0.6, 1.1, 0.5, 0.4, 1.2},
          {"bend_right", 1.1, slim, 1.5, -0.8, 0, -1.7, 1.05, 0.4, 1.7, 1.1},
          {"curl", 0.92, full, 1.5, 0, 0, 2.6, 1.4, 1.1, -0.3, 0.95},
          {"jump", 1.2, slim, 1.5, 0, 0.45, -0.9, 1.2, 1.6, 1.6, 1.3}};
}

SpaceWarp WarpOf(const FoxGesture& gesture, double amount) {
  const auto girth = [amount, full = gesture.girth](double y) {
    return 1 + amount * (full(y) - 1);
  };
  return Then(Then(Swell(Mix(1, gesture.height, amount), girth, gesture.reach),
                   BendAboutZ(amount * gesture.bend, 0.05, 1.15)),
              Shift({0, amount * gesture.jump, 0}));
}

// A limb turned by `turn` more than it turns at rest.
LimbPose Bent(const Limb& limb, double length, double turn) {
  return {length, 1, Both(RestTurn(limb), [turn](double u) {
            return Vector3d(0, 0, turn * 2 * SmoothStep(0, 1, u));
          })};
}

Pose PoseFox(const FoxModel& fox, const GestureMix& mix) {
  SpaceWarp warp = Shift(Vector3d::Zero());
  std::vector<std::pair<double, LimbPose>> tail, left, right;
  for (const FoxGesture& gesture : FoxGestures()) {
    const double amount = AmountOf(gesture.name, mix);
    if (amount == 0) continue;
    warp = Then(warp, WarpOf(gesture, amount));
    tail.emplace_back(amount, Bent(fox.tail, gesture.tail_length, gesture.tail_turn));
    left.emplace_back(amount, Bent(fox.arm_left, gesture.arms_length, -gesture.left_turn));
    right.emplace_back(amount, Bent(fox.arm_right, gesture.arms_length, gesture.right_turn));
  }
  Pose pose(warp);
  pose.Add(fox.tail, Mixed(fox.tail, tail));
  pose.Add(fox.arm_left, Mixed(fox.arm_left, left));
  pose.Add(fox.arm_right, Mixed(fox.arm_right, right));
  return pose;
}

}  // namespace

Character MakeFox() {
  const FoxModel model;
  Character fox;
  fox.name = "fox";
  const auto paper = [&](const Vector2d& p) { return model.Distance(p) - kFoxPaper - kFoxMargin; };
  const PlanarMesh mesh =
      FillOutline(paper, {kLeft, kBottom}, {kLeft + kSize, kBottom + kSize}, kSpacing);
  fox.shapes = {{"rest", {}}};
  for (const Vector2d& p : mesh.positions) {
    fox.shapes[0].positions.emplace_back(p.x(), p.y(), 0);
    fox.normals.emplace_back(0, 0, 1);
    fox.texcoords.emplace_back((p.x() - kLeft) / kSize, 1 - (p.y() - kBottom) / kSize);
  }
  std::vector<double> smoothing;
  for (const Vector3d& p : fox.shapes[0].positions)
    smoothing.push_back(SmoothingAt(p, {&model.tail}));
  for (const FoxGesture& gesture : FoxGestures()) {
    const Pose pose = PoseFox(model, {{gesture.name, 1}});
    Shape shape{gesture.name, {}};
    for (const Vector3d& p : fox.shapes[0].positions)
      shape.positions.push_back(pose(p));
    SmoothOffsets(mesh.triangles, fox.shapes[0].positions, kSmoothing, smoothing, &shape.positions);
    fox.shapes.push_back(std::move(shape));
  }
  Primitive primitive;
  primitive.num_vertices = static_cast<uint32_t>(mesh.positions.size());
  primitive.triangles = mesh.triangles;
  fox.primitives = {primitive};
  fox.materials = {{.name = "paper", .double_sided = true, .alpha_cut = true}};
  fox.picture = Paint(kPixels, kPixels, 2, [&](double x, double y) {
    return FoxColour(model, {kLeft + x / kPixels * kSize, kBottom + (1 - y / kPixels) * kSize});
  });
  const auto handle = [&](const char* name, double x, double y, bool pinned) {
    fox.handles.push_back({name, NearestVertex(fox, {x, y, 0}), pinned});
  };
  handle("head", 0, 1.7, true);
  handle("belly", 0, 0.5, true);
  handle("hand_left", -0.5, 0.58, true);
  handle("hand_right", 0.5, 0.58, true);
  handle("foot_left", -0.16, 0.07, true);
  handle("foot_right", 0.16, 0.07, true);
  handle("tail_tip", 1.06, 1.02, true);
  RoundPositions(&fox);
  return fox;
}

std::string MakeFoxDrag(const Character& fox) {
  const FoxModel model;
  const auto posing = [&model](const GestureMix& mix) -> SpaceWarp { return PoseFox(model, mix); };
  return WriteDrag(fox, posing,
                   {{{{"squash", 0.85}}, 8},
                    {{{"stretch", 0.95}}, 10},
                    {{}, 9},
                    {{{"bend_left", 0.95}}, 11},
                    {{{"bend_right", 0.95}}, 14},
                    {{{"curl", 0.95}}, 14},
                    {{{"squash", 0.9}}, 8},
                    {{{"jump", 1}}, 9},
                    {{{"squash", 0.6}}, 7},
                    {{}, 9}});
}

}  // namespace limber::content
