#include "generate/fox.h"

#include "generate/drag.h"
#include "generate/fox_parts.h"
#include "generate/planar_mesh.h"
#include "generate/pose.h"
#include "generate/shaping.h"
#include "generate/smooth_offsets.h"
#include "generate/space_warp.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace limber::content {
namespace {

constexpr int kPixels = 1024;
constexpr int kSmoothing = 10;
constexpr double kSpacing = 0.042;
// The part of the plane that the picture shows, a square.
constexpr double kLeft = -0.7, kBottom = -0.12, kSize = 2.3;

struct FoxShape {
  const char* name;
  SpaceWarp warp;
  double tail_turn, tail_length;              // radians over its length, times its length at rest
  double left_turn, right_turn, arms_length;  // upwards
};

// A limb turned by `turn` more than it turns at rest.
LimbPose Bent(const Limb& limb, double length, double turn) {
  const auto heading = [&limb](double u) {
    const Vector3d t = limb.spine.Frame(u).col(2);
    return std::atan2(t.y(), t.x());
  };
  const auto rate = [heading, turn](double u) {
    const double a = std::max(u - 0.01, 0.0), b = std::min(u + 0.01, 1.0);
    const double at_rest = std::remainder(heading(b) - heading(a), 2 * std::numbers::pi) / (b - a);
    return Vector3d(0, 0, at_rest + turn * 2 * SmoothStep(0, 1, u));
  };
  return {length, 1, rate};
}

Pose PoseFox(const FoxModel& fox, const FoxShape& shape) {
  Pose pose(shape.warp);
  pose.Add(fox.tail, Bent(fox.tail, shape.tail_length, shape.tail_turn));
  pose.Add(fox.arm_left, Bent(fox.arm_left, shape.arms_length, -shape.left_turn));
  pose.Add(fox.arm_right, Bent(fox.arm_right, shape.arms_length, shape.right_turn));
  return pose;
}

std::vector<FoxShape> FoxShapes() {
  const auto stretch = [](double y) { return 0.82 - 0.1 * Bump(y, 0.7, 0.4); };
  const auto squash = [](double y) { return 1.35 + 0.15 * Bump(y, 0.4, 0.5); };
  const auto slim = [](double y) { return 0.93 - 0.05 * Bump(y, 0.7, 0.4); };
  return {{"stretch", Swell(1.45, stretch, 1.5), -0.4, 1.15, -0.35, -0.35, 1.2},
          {"squash", Swell(0.58, squash, 1.2), -0.5, 1.0, 0.5, 0.5, 1.15},
          {"bend_left", Then(Swell(1.1, slim, 1.5), BendAboutZ(0.9, 0.05, 1.15)), -0.6, 1.1, 0.5,
           0.4, 1.2},
          {"bend_right", Then(Swell(1.1, slim, 1.5), BendAboutZ(-0.8, 0.05, 1.15)), -1.7, 1.05, 0.4,
           1.7, 1.1},
          {"curl",
           Swell(
               0.92, [](double) { return 1.05; }, 1.5),
           2.6, 1.4, 1.1, -0.3, 0.95},
          {"jump", Then(Swell(1.2, slim, 1.5), Shift({0, 0.45, 0})), -0.9, 1.2, 1.6, 1.6, 1.3}};
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
  for (const FoxShape& wish : FoxShapes()) {
    const Pose pose = PoseFox(model, wish);
    Shape shape{wish.name, {}};
    for (const Vector3d& p : fox.shapes[0].positions)
      shape.positions.push_back(pose(p));
    SmoothOffsets(mesh.triangles, fox.shapes[0].positions, kSmoothing, &shape.positions);
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
  return WriteDrag(fox, {{"squash", 0.9, {}, 7},
                         {"stretch", 1.05, {}, 8},
                         {"rest", 0, {}, 7},
                         {"bend_left", 1, {}, 9},
                         {"bend_right", 1.05, {}, 10},
                         {"rest", 0, {}, 7},
                         {"curl", 1, {"tail_tip", "hand_right"}, 8},
                         {"squash", 1, {}, 6},
                         {"jump", 1.1, {}, 6},
                         {"jump", 1, {}, 4},
                         {"squash", 0.8, {}, 5},
                         {"rest", 0, {}, 7}});
}

}  // namespace limber::content
