#include "generate/dragonlet.h"

#include "generate/atlas.h"
#include "generate/drag.h"
#include "generate/dragonlet_parts.h"
#include "generate/shaping.h"
#include "generate/smooth_offsets.h"
#include "generate/surface.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace limber::content {
namespace {

constexpr int kPixels = 1024, kEyePixels = 224;
constexpr int kSmoothing = 14;
constexpr double kCell = 0.05;

// An eye's picture is a disc: the middle looks ahead, the rim behind. The front half of the eye
// takes most of it.
double DiscRadius(double polar) {
  const double half = std::numbers::pi / 2;
  return polar < half ? 0.42 * polar / half : 0.42 + 0.06 * (polar - half) / half;
}

Colour EyePixel(double x, double y) {
  const Vector2d at(x / kEyePixels - 0.5, 0.5 - y / kEyePixels);
  const double radius = at.norm(), half = std::numbers::pi / 2;
  const double polar =
      radius < 0.42 ? radius / 0.42 * half : half * (1 + std::min((radius - 0.42) / 0.06, 1.0));
  const Vector2d way = radius > 0 ? Vector2d(at / radius) : Vector2d(1, 0);
  return DragonletEyeColour(
      {std::sin(polar) * way.x(), std::sin(polar) * way.y(), std::cos(polar)});
}

// Appends one eye: rings about its axis; the pole behind is split so that its picture stays flat.
void AddEye(const DragonletEye& eye, const std::vector<DragonletPoser>& posers,
            Character* dragonlet, Primitive* primitive) {
  constexpr int kAround = 28, kRings = 14;
  const auto base = static_cast<uint32_t>(dragonlet->normals.size() - primitive->first_vertex);
  // The eyes sit turned outwards with the head's surface, but look a little inwards from there.
  const Eigen::AngleAxisd look(eye.centre.x() > 0 ? -0.2 : 0.2, Vector3d::UnitY());
  const auto add = [&](double polar, double azimuth) {
    const Vector3d unit(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                        std::cos(polar));
    const Vector3d on_ball = look * unit;
    const Vector3d p = eye.centre + eye.axes * on_ball.cwiseProduct(eye.radii);
    for (size_t s = 0; s < posers.size(); ++s) {
      dragonlet->shapes[s].positions.push_back(posers[s].Eye(eye, p));
    }
    dragonlet->normals.emplace_back((eye.axes * on_ball.cwiseQuotient(eye.radii)).normalized());
    const double r = DiscRadius(polar);
    const Vector2d disc(0.5 + r * std::cos(azimuth), 0.5 - r * std::sin(azimuth));
    // The eyes' square is the lower right corner of the picture.
    dragonlet->texcoords.emplace_back(
        (disc * kEyePixels + Vector2d::Constant(kPixels - kEyePixels)) / kPixels);
  };
  add(0, 0);
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      add(std::numbers::pi * ring / kRings, 2 * std::numbers::pi * i / kAround);
    }
  }
  const auto at = [&](int ring, int i) {
    return ring == 0 ? base : base + 1 + static_cast<uint32_t>((ring - 1) * kAround + i % kAround);
  };
  for (int ring = 0; ring < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const uint32_t a = at(ring, i), b = at(ring + 1, i), c = at(ring + 1, i + 1),
                     d = at(ring, i + 1);
      if (ring + 1 < kRings) primitive->triangles.insert(primitive->triangles.end(), {a, b, c});
      if (ring + 1 == kRings) primitive->triangles.insert(primitive->triangles.end(), {a, b, d});
      if (ring > 0 && ring + 1 < kRings) {
        primitive->triangles.insert(primitive->triangles.end(), {a, c, d});
      }
    }
  }
}

void AddBody(const DragonletModel& model, const std::vector<DragonletPoser>& posers,
             Character* dragonlet) {
  const Surface surface = ExtractSurface([&](const Vector3d& p) { return model.Distance(p); },
                                         {-1.4, -0.25, -1.6}, {1.7, 2.3, 1.0}, kCell);
  const auto part = [&](const Vector3d& p) {
    const DragonletPart nearest = model.NearestPart(p);
    // Small or shallow parts share the trunk's charts; they hide nothing behind them.
    const bool trunk = nearest == DragonletPart::kSnout || nearest == DragonletPart::kRidge;
    return static_cast<int>(trunk ? DragonletPart::kCore : nearest);
  };
  const Atlas atlas =
      MakeAtlas(surface, part, {1, 1, 1, 0.6, 1.4, 1}, kPixels, kPixels - kEyePixels);
  Image& picture = dragonlet->picture;
  picture = Paint(kPixels, kPixels, 1, [](double, double) { return Hex(0x46C8B3); });
  PaintAtlas(
      surface, atlas, [&](const Vector3d& p) { return DragonletSkin(model, p); }, &picture);
  Primitive body;
  body.num_vertices = static_cast<uint32_t>(atlas.surface_vertex.size());
  body.triangles = atlas.triangles;
  dragonlet->primitives.push_back(body);
  for (size_t s = 0; s < posers.size(); ++s) {
    std::vector<Vector3d> posed;
    for (const Vector3d& p : surface.positions)
      posed.push_back(posers[s].Body(p));
    SmoothOffsets(surface.triangles, surface.positions, kSmoothing, &posed);
    for (uint32_t v : atlas.surface_vertex)
      dragonlet->shapes[s].positions.push_back(posed[v]);
  }
  for (size_t v = 0; v < atlas.surface_vertex.size(); ++v) {
    dragonlet->normals.push_back(surface.normals[atlas.surface_vertex[v]]);
    dragonlet->texcoords.emplace_back(atlas.pixels[v] / kPixels);
  }
}

void PaintEyes(Image* picture) {
  const Image eye = Paint(kEyePixels, kEyePixels, 3, EyePixel);
  for (int y = 0; y < kEyePixels; ++y) {
    for (int x = 0; x < kEyePixels; ++x) {
      const uint8_t* from = &eye.rgba[4 * (static_cast<size_t>(y) * kEyePixels + x)];
      const int to_x = kPixels - kEyePixels + x, to_y = kPixels - kEyePixels + y;
      std::copy(from, from + 4, &picture->rgba[4 * (static_cast<size_t>(to_y) * kPixels + to_x)]);
    }
  }
}

}  // namespace

Character MakeDragonlet() {
  const DragonletModel model;
  Character dragonlet;
  dragonlet.name = "dragonlet";
  std::vector<DragonletPoser> posers;
  for (int s = 0; s < kNumDragonletShapes; ++s) {
    posers.emplace_back(model, s);
    dragonlet.shapes.push_back({DragonletShapeName(s), {}});
  }
  AddBody(model, posers, &dragonlet);
  Primitive eyes;
  eyes.first_vertex = static_cast<uint32_t>(dragonlet.normals.size());
  eyes.material = 1;
  for (bool left : {true, false})
    AddEye(model.Eye(left), posers, &dragonlet, &eyes);
  eyes.num_vertices = static_cast<uint32_t>(dragonlet.normals.size()) - eyes.first_vertex;
  dragonlet.primitives.push_back(eyes);
  PaintEyes(&dragonlet.picture);
  dragonlet.materials = {{.name = "skin"}, {.name = "eyes", .roughness = 0.2}};
  const Vector3d tail_tip = model.tail().spine.Point(1),
                 tail_middle = model.tail().spine.Point(0.55), hand = model.arm().spine.Point(1),
                 ear = model.ear().spine.Point(1);
  const auto handle = [&](const char* name, const Vector3d& p, bool pinned) {
    dragonlet.handles.push_back({name, NearestVertex(dragonlet, p), pinned});
  };
  handle("head", {0, 1.95, 0.1}, true);
  handle("nose", {0, 1.07, 0.75}, true);
  handle("belly", {0, 0.45, 0.6}, true);
  handle("back", {0, 0.75, -0.55}, true);
  handle("hand_left", hand, true);
  handle("hand_right", Mirrored(hand), true);
  handle("foot_left", {0.27, 0.1, 0.6}, true);
  handle("foot_right", {-0.27, 0.1, 0.6}, true);
  handle("ear_left", ear, true);
  handle("ear_right", Mirrored(ear), true);
  handle("tail_middle", tail_middle, true);
  handle("tail_tip", tail_tip, true);
  RoundPositions(&dragonlet);
  return dragonlet;
}

std::string MakeDragonletDrag(const Character& dragonlet) {
  const std::vector<std::string> greeting = {"hand_left", "ear_left", "head"};
  // By way of a stretch the tail swings behind the body from side to side, not through it.
  return WriteDrag(dragonlet, {{"squash", 0.9, {}, 7},
                               {"stretch", 1.05, {}, 8},
                               {"squash", 0.45, {}, 6},
                               {"rest", 0, {}, 5},
                               {"wave", 1, greeting, 7},
                               {"wave", 0.75, greeting, 3},
                               {"wave", 1.05, greeting, 3},
                               {"curl", 1, {}, 9},
                               {"stretch", 0.45, {}, 7},
                               {"lean_left", 1, {}, 8},
                               {"stretch", 0.55, {}, 8},
                               {"lean_right", 1.05, {}, 8},
                               {"puff", 1.05, {}, 8},
                               {"puff", 0.95, {}, 3},
                               {"startled", 1, {}, 8},
                               {"rest", 0, {}, 8}});
}

}  // namespace limber::content
