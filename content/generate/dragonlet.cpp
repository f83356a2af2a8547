#include "generate/dragonlet.h"

#include "generate/atlas.h"
#include "generate/drag.h"
#include "generate/dragonlet_parts.h"
#include "generate/shaping.h"
#include "generate/smooth_offsets.h"
#include "generate/surface.h"

#include <Eigen/Geometry>

#include <cmath>
#include <memory>
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
  std::vector<double> smoothing;
  for (const Vector3d& p : surface.positions) {
    const Vector3d left(std::abs(p.x()), p.y(), p.z());
    smoothing.push_back(
        std::min(SmoothingAt(p, {&model.tail()}), SmoothingAt(left, {&model.arm(), &model.ear()})));
  }
  for (size_t s = 0; s < posers.size(); ++s) {
    std::vector<Vector3d> posed;
    for (const Vector3d& p : surface.positions)
      posed.push_back(posers[s].Body(p));
    SmoothOffsets(surface.triangles, surface.positions, kSmoothing, smoothing, &posed);
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

// Where a limb's surface lies towards `side` of its spine. Handles of arms and ears are a little
// back from the tip: a pull then moves all of the tip, not a spike of it.
Vector3d OnLimb(const Limb& limb, double u, const Vector3d& side) {
  const Vector3d tangent = limb.spine.Frame(u).col(2);
  const Vector3d across = (side - tangent * tangent.dot(side)).normalized();
  return limb.spine.Point(u) + limb.radius(u) * across;
}

void AddHandles(const DragonletModel& model, Character* dragonlet) {
  const Vector3d up = Vector3d::UnitY(), ahead = Vector3d::UnitZ();
  const Vector3d hand = OnLimb(model.arm(), 0.88, ahead), ear = OnLimb(model.ear(), 0.87, ahead);
  // The tail swings far and fast. Its flame is held at both ends, else it would turn after the tail
  // over many frames, and hang folded until then; and at its root from below, else nothing would
  // say how the tail rolls.
  const Vector3d tail_tip = OnLimb(model.tail(), 1, up),
                 tail_flame = OnLimb(model.tail(), 0.76, -up),
                 tail_middle = OnLimb(model.tail(), 0.45, up);
  const auto handle = [&](const char* name, const Vector3d& p, bool pinned) {
    dragonlet->handles.push_back({name, NearestVertex(*dragonlet, p), pinned});
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
  handle("tail_flame", tail_flame, true);
  handle("tail_tip", tail_tip, true);
}

}  // namespace

Character MakeDragonlet() {
  const DragonletModel model;
  Character dragonlet;
  dragonlet.name = "dragonlet";
  std::vector<DragonletPoser> posers;
  for (const DragonletShape& shape : DragonletShapes()) {
    posers.emplace_back(model, shape.mix);
    dragonlet.shapes.push_back({shape.name, {}});
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
  AddHandles(model, &dragonlet);
  RoundPositions(&dragonlet);
  return dragonlet;
}

std::string MakeDragonletDrag(const Character& dragonlet) {
  const DragonletModel model;
  const auto posing = [&model](const GestureMix& mix) -> SpaceWarp {
    const auto poser = std::make_shared<DragonletPoser>(model, mix);
    return [poser](const Vector3d& p) { return poser->Body(p); };
  };
  // Gestures with the tail on one side follow each other: from side to side is a long way for it,
  // and takes its time.
  return WriteDrag(dragonlet, posing,
                   {{{{"squash", 0.85}}, 8},
                    {{{"stretch", 0.95}}, 9},
                    {{{"curl", 1}}, 13},
                    {{}, 12},
                    {{{"wave", 1}}, 17},
                    {{{"wave", 0.8}}, 4},
                    {{{"wave", 1}}, 4},
                    {{{"lean_left", 0.95}}, 11},
                    {{{"lean_right", 0.95}}, 20},
                    {{{"puff", 0.95}}, 10},
                    {{{"startled", 0.95}}, 9},
                    {{}, 10}});
}

}  // namespace limber::content
