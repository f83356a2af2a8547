#include "generate/fox_parts.h"
#include "generate/shaping.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace limber::content {
namespace {

constexpr double kLine = 0.011, kSoft = 0.004;
const Colour kInk = Hex(0x4A2530), kOrange = Hex(0xF5853F), kDeep = Hex(0xDE6428),
             kCream = Hex(0xFFF1DC), kSock = Hex(0x6B3440), kTeal = Hex(0x2BA6A4);

Vector2d Folded(const Vector2d& p) {
  return {std::abs(p.x()), p.y()};
}

Limb MakeLimb(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
              std::function<double(double)> radius) {
  Limb limb{Curve::Bezier(a, b, c, d), std::move(radius), 0.7};
  // The paper around the limb goes with it, the trunk beside it does not.
  limb.near = 1;
  limb.far = 1.25;
  limb.margin = kFoxPaper + kFoxMargin;
  return limb;
}

// A shape filled with one colour inside an ink line.
void Fill(double distance, const Colour& paint, Colour* ground) {
  Cover(kInk, Inside(distance - kLine, kSoft), ground);
  Cover(paint, Inside(distance, kSoft), ground);
}

double LimbInPlane(const Limb& limb, const Vector2d& p) {
  return limb.Distance({p.x(), p.y(), 0});
}

double LimbParameter(const Limb& limb, const Vector2d& p) {
  return limb.spine.Nearest({p.x(), p.y(), 0}).u;
}

void PaintTail(const FoxModel& fox, const Vector2d& p, Colour* ground) {
  const double d = fox.Tail(p);
  if (d > 2 * kLine) return;
  Colour fur = kOrange;
  const double u = LimbParameter(fox.tail, p);
  Cover(kDeep, 0.6 * Inside(u - 0.18, 0.3), &fur);
  const Vector3d across =
      fox.tail.spine.Frame(u).transpose() * (Vector3d(p.x(), p.y(), 0) - fox.tail.spine.Point(u));
  // The white tip begins in zigzags.
  const double side = across.head<2>().sum() / 0.085;
  const double zigzag = std::abs(side - 2 * std::floor(side / 2) - 1);
  Cover(kInk, Inside(0.66 - u + 0.06 * zigzag - 0.012, 0.006), &fur);
  Cover(kCream, Inside(0.675 - u + 0.06 * zigzag, 0.006), &fur);
  Fill(d, fur, ground);
}

void PaintTrunk(const FoxModel& fox, const Vector2d& p, Colour* ground) {
  Colour sock = kOrange;
  Cover(kSock, Inside(p.y() - 0.17 - 0.02 * std::sin(40 * p.x()), kSoft), &sock);
  Fill(fox.Legs(p), sock, ground);
  Colour fur = kOrange;
  Cover(kDeep, 0.5 * Inside(p.y() - 0.25, 0.3), &fur);
  Cover(kCream, Inside(EllipseDistance(p, {0, 0.56}, {0.165, 0.3}), 0.006), &fur);
  Fill(fox.Trunk(p), fur, ground);
  for (const Limb* arm : {&fox.arm_left, &fox.arm_right}) {
    if (LimbInPlane(*arm, p) > 2 * kLine) continue;
    Colour paw = kOrange;
    Cover(kSock, Inside(0.56 - LimbParameter(*arm, p), 0.01), &paw);
    Fill(LimbInPlane(*arm, p), paw, ground);
  }
}

// A scarf, with two ends that hang to one side.
void PaintScarf(const Vector2d& p, Colour* ground) {
  const auto knit = [](double along) {
    Colour wool = kTeal;
    const double t = along / 0.075;
    Cover(Hex(0xF9D77E), Inside(std::abs(t - std::floor(t) - 0.5) - 0.13, 0.06), &wool);
    return wool;
  };
  Fill(TaperDistance(p, {0.1, 0.9}, {0.17, 0.62}, 0.05, 0.066), knit(p.y() + 0.2 * p.x()), ground);
  const double sag = 0.9 - 0.05 * (1 - p.x() * p.x() / 0.09);
  const double band = std::max(std::abs(p.y() - sag) - 0.06, std::abs(p.x()) - 0.265);
  Fill(band, knit(p.x() + 0.15 * p.y()), ground);
  Fill(EllipseDistance(p, {0.1, 0.865}, {0.06, 0.068}), kTeal, ground);
}

void PaintEye(const Vector2d& q, double mirror, Colour* face) {
  Cover(kInk, Inside(EllipseDistance(q, {0.205, 1.345}, {0.083, 0.112}), kSoft), face);
  const Vector2d spark(0.205 + mirror * -0.026, 1.39), small(0.205 + mirror * 0.026, 1.308);
  Cover(Hex(0x8A4A52), Inside(EllipseDistance(q, {0.205, 1.288}, {0.056, 0.044}), 0.04), face);
  Cover(Hex(0xFFFFFF), Inside((q - spark).norm() - 0.033, kSoft), face);
  Cover(Hex(0xFFFFFF), Inside((q - small).norm() - 0.013, kSoft), face);
  // Two lashes, and a brow high above.
  Cover(kInk, Inside(TaperDistance(q, {0.268, 1.42}, {0.312, 1.455}, 0.012, 0.005), kSoft), face);
  Cover(kInk, Inside(TaperDistance(q, {0.282, 1.388}, {0.328, 1.408}, 0.011, 0.005), kSoft), face);
  const double brow = ArcDistance(q, {0.2, 1.455}, 0.105, 1.0, 2.1) - 0.011;
  Cover(kDeep, Inside(brow, kSoft), face);
}

void PaintFace(const FoxModel& fox, const Vector2d& p, Colour* ground) {
  const Vector2d q = Folded(p);
  Fill(fox.Ears(p), kOrange, ground);
  Cover(kSock, Inside(std::max(fox.Ears(p), 1.9 - p.y() - 0.1 * q.x()), kSoft), ground);
  const double lining = TriangleDistance(q, {0.25, 1.6}, {0.42, 1.58}, {0.41, 1.86}) - 0.025;
  Cover(kCream, Inside(lining, kSoft), ground);
  Colour face = kOrange;
  // The mask: a white bow from cheek to cheek, below the eyes.
  const double mask = SmoothMin(EllipseDistance(q, {0.3, 1.17}, {0.31, 0.15}),
                                EllipseDistance(q, {0, 1.11}, {0.2, 0.13}), 0.08);
  Cover(kCream, Inside(mask, 0.006), &face);
  Cover(kDeep, 0.75 * Inside(TaperDistance(q, {0, 1.75}, {0, 1.5}, 0.06, 0.004), 0.02), &face);
  PaintEye(q, p.x() < 0 ? -1 : 1, &face);
  Cover(Hex(0xFF9C8F), 0.8 * Inside(EllipseDistance(q, {0.365, 1.2}, {0.075, 0.048}), 0.03), &face);
  Cover(kInk, Inside(EllipseDistance(q, {0, 1.235}, {0.058, 0.042}), 0.006), &face);
  Cover(Hex(0xFFFFFF), 0.8 * Inside(EllipseDistance(p, {-0.016, 1.25}, {0.016, 0.008}), 0.008),
        &face);
  const double pi = std::numbers::pi;
  Cover(kInk, Inside(SegmentDistance(q, {0, 1.2}, {0, 1.16}) - 0.008, kSoft), &face);
  Cover(kInk, Inside(ArcDistance(q, {0.055, 1.16}, 0.055, -pi, -0.15 * pi) - 0.009, kSoft), &face);
  Fill(fox.Head(p), face, ground);
}

}  // namespace

FoxModel::FoxModel()
    : tail(MakeLimb({0.15, 0.27, 0}, {0.78, 0.04, 0}, {1.27, 0.36, 0}, {1.06, 1.02, 0},
                    [](double u) { return 0.06 + 0.155 * Bump(u, 0.66, 0.32) - 0.02 * u; })),
      arm_left(MakeLimb({-0.14, 0.77, 0}, {-0.26, 0.76, 0}, {-0.4, 0.7, 0}, {-0.5, 0.58, 0},
                        [](double u) { return 0.068 + 0.012 * u; })),
      arm_right(MakeLimb({0.14, 0.77, 0}, {0.26, 0.76, 0}, {0.4, 0.7, 0}, {0.5, 0.58, 0},
                         [](double u) { return 0.068 + 0.012 * u; })) {
  tail.root = 0.35;
}

double FoxModel::Head(const Vector2d& p) const {
  const Vector2d q = Folded(p);
  const double skull = EllipseDistance(q, {0, 1.36}, {0.46, 0.35});
  const double cheek = TriangleDistance(q, {0.2, 1.05}, {0.6, 1.2}, {0.3, 1.4}) - 0.04;
  const double chin = EllipseDistance(q, {0, 1.12}, {0.26, 0.15});
  return SmoothMin(SmoothMin(skull, cheek, 0.1), chin, 0.1);
}

double FoxModel::Ears(const Vector2d& p) const {
  return TriangleDistance(Folded(p), {0.12, 1.55}, {0.46, 1.45}, {0.44, 1.95}) - 0.045;
}

double FoxModel::Trunk(const Vector2d& p) const {
  return SmoothMin(EllipseDistance(p, {0, 0.44}, {0.27, 0.3}),
                   EllipseDistance(p, {0, 0.75}, {0.2, 0.27}), 0.15);
}

double FoxModel::Legs(const Vector2d& p) const {
  const Vector2d q = Folded(p);
  return SmoothMin(TaperDistance(q, {0.15, 0.3}, {0.15, 0.09}, 0.1, 0.085),
                   EllipseDistance(q, {0.17, 0.075}, {0.125, 0.075}), 0.06);
}

double FoxModel::Arms(const Vector2d& p) const {
  return std::min(LimbInPlane(arm_left, p), LimbInPlane(arm_right, p));
}

double FoxModel::Tail(const Vector2d& p) const {
  return LimbInPlane(tail, p);
}

double FoxModel::Distance(const Vector2d& p) const {
  double d = SmoothMin(Head(p), Ears(p), 0.06);
  d = SmoothMin(d, Trunk(p), 0.06);
  d = SmoothMin(d, Legs(p), 0.06);
  d = SmoothMin(d, Arms(p), 0.05);
  return SmoothMin(d, Tail(p), 0.06);
}

Colour FoxColour(const FoxModel& fox, const Vector2d& p) {
  Colour colour = Hex(0xFFFBF2);
  colour[3] = Inside(fox.Distance(p) - kFoxPaper, kSoft);
  if (colour[3] == 0) return colour;
  const double alpha = std::exchange(colour[3], 1.0);
  PaintTail(fox, p, &colour);
  PaintTrunk(fox, p, &colour);
  PaintScarf(p, &colour);
  PaintFace(fox, p, &colour);
  colour[3] = alpha;
  return colour;
}

}  // namespace limber::content
