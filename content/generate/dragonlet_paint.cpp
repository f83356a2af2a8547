#include "generate/dragonlet_parts.h"
#include "generate/shaping.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::content {
namespace {

// Seen from the front: a smile with a tongue and two small fangs, and the nostrils.
void PaintMouth(const Vector2d& at, Colour* skin) {
  const Vector2d q(std::abs(at.x()), at.y());
  // A "D" on its back: below a sagging line, inside an ellipse.
  const double lip = 1.005 - 0.35 * (0.15 * 0.15 - at.x() * at.x());
  const double mouth = std::max(EllipseDistance(at, {0, 1.015}, {0.15, 0.12}), at.y() - lip);
  Cover(Hex(0x17696F), Inside(mouth - 0.013, 0.012), skin);
  Cover(Hex(0x7A1F3D), Inside(mouth, 0.008), skin);
  const double tongue = std::max(mouth + 0.006, EllipseDistance(at, {0, 0.91}, {0.085, 0.055}));
  Cover(Hex(0xFF7D8C), Inside(tongue, 0.012), skin);
  const double fang = std::max(mouth + 0.002, EllipseDistance(q, {0.088, 0.997}, {0.02, 0.034}));
  Cover(Hex(0xFFFFFF), Inside(fang, 0.008), skin);
  Cover(Hex(0x17696F), Inside(EllipseDistance(q, {0.075, 1.135}, {0.02, 0.014}), 0.012), skin);
}

void PaintFace(const DragonletModel& model, const Vector3d& p, Colour* skin) {
  const double front = SmoothStep(0.1, 0.2, p.z());
  const Vector2d at(p.x(), p.y());
  const Vector2d q(std::abs(p.x()), p.y());
  Colour face = *skin;
  Cover(Hex(0xC9F5DA), 0.75 * Inside(EllipseDistance(q, {0, 1.0}, {0.27, 0.19}), 0.1), &face);
  Cover(Hex(0xFF8F86), 0.85 * Inside(EllipseDistance(q, {0.45, 1.05}, {0.11, 0.075}), 0.07), &face);
  PaintMouth(at, &face);
  // Brows: short arches high above the eyes.
  const double brow = ArcDistance(q, {0.255, 1.44}, 0.17, 1.15, 1.95) - 0.013;
  Cover(Hex(0x1B7F86), Inside(brow, 0.012), &face);
  Cover(face, front, skin);
  // A dark rim where the eyes come out of the head, stronger above like lashes.
  const Vector3d local = model.Eye(p.x() > 0).Local(p);
  const double rim = (local.norm() - 1) * 0.19;
  const double lash = 0.016 + 0.02 * SmoothStep(0.1, 0.9, local.y());
  Cover(Hex(0x124B57), Inside(rim - lash, 0.012), skin);
}

void PaintSpots(const Vector3d& p, Colour* skin) {
  const Vector3d q(std::abs(p.x()), p.y(), p.z());
  constexpr double kSpots[9][4] = {
      {0.1, 1.78, 0.12, 0.05},   {0.32, 1.66, -0.2, 0.085}, {0.5, 1.42, -0.25, 0.06},
      {0.27, 1.35, -0.47, 0.09}, {0.3, 0.86, -0.25, 0.07},  {0.42, 0.6, -0.24, 0.085},
      {0.24, 0.45, -0.42, 0.06}, {0.5, 1.2, -0.22, 0.045},  {0.3, 1.1, -0.42, 0.05}};
  for (const auto& [x, y, z, radius] : kSpots) {
    const double d = (q - Vector3d(x, y, z)).norm() - radius;
    Cover(Hex(0x1E9AA0), 0.55 * Inside(d, 0.03), skin);
  }
}

void PaintBelly(const Vector3d& p, Colour* skin) {
  const double patch = EllipseDistance({p.x(), p.y()}, {0, 0.45}, {0.33, 0.43});
  Colour cream = Hex(0xFFEFC9);
  // Plates: fine lines that sag with the belly.
  const double height = p.y() + 0.25 * p.x() * p.x();
  const double in_plate = std::abs(height / 0.125 - std::floor(height / 0.125) - 0.5);
  Cover(Hex(0xF3CD93), 0.8 * SmoothStep(0.4, 0.48, in_plate), &cream);
  Cover(cream, SmoothStep(0.05, 0.12, p.z()) * Inside(patch, 0.03), skin);
}

void PaintTail(const DragonletModel& model, const Vector3d& p, Colour* skin) {
  const Curve::Foot foot = model.tail().spine.Nearest(p);
  for (double u : {0.36, 0.5, 0.64}) {
    Cover(Hex(0x1E9AA0), 0.45 * Inside(std::abs(foot.u - u) - 0.022, 0.02), skin);
  }
  Colour tip = Hex(0xFF8A5B);
  Cover(Hex(0xFFD166), SmoothStep(0.86, 1.0, foot.u), &tip);
  // A wavy border, as if dipped in paint.
  const Eigen::Matrix3d frame = model.tail().spine.Frame(foot.u);
  const Vector3d across = frame.transpose() * (p - model.tail().spine.Point(foot.u));
  const double wave = 0.02 * std::sin(5 * std::atan2(across.y(), across.x()));
  Cover(tip, SmoothStep(0.765, 0.785, foot.u + wave), skin);
}

void PaintEar(const DragonletModel& model, const Vector3d& p, Colour* skin) {
  const Vector3d q(std::abs(p.x()), p.y(), p.z());
  const Curve::Foot foot = model.ear().spine.Nearest(q);
  const Vector3d from = q - model.ear().spine.Point(foot.u);
  // The lining: a smaller leaf inside the leaf.
  const double leaf = 0.68 * SmoothStep(0.25, 0.6, foot.u) * (1 - SmoothStep(0.66, 0.9, foot.u));
  const double inner =
      (from - from.z() * Vector3d::UnitZ()).norm() - model.ear().radius(foot.u) * leaf;
  const double faces_front = SmoothStep(0.0, 0.03, from.z());
  Colour lining = Hex(0xFFA69E);
  Cover(Hex(0xFF7F87), SmoothStep(0.5, 0.9, foot.u), &lining);
  Cover(lining, faces_front * Inside(inner, 0.02), skin);
  Cover(Hex(0xFF8A5B), SmoothStep(0.84, 0.88, foot.u), skin);
}

// Three round nails on each foot.
void PaintFoot(const Vector3d& p, Colour* skin) {
  const Vector3d q(std::abs(p.x()), p.y(), p.z());
  for (int nail = -1; nail <= 1; ++nail) {
    const Vector3d at(0.27 + 0.1 * nail, 0.1, 0.43 - 0.03 * std::abs(nail));
    Cover(Hex(0xFFF3D6), Inside((q - at).norm() - 0.045, 0.015), skin);
  }
}

}  // namespace

Colour DragonletSkin(const DragonletModel& model, const Vector3d& p) {
  const Colour low = Hex(0x2FB5AE), high = Hex(0x5FDDB4);
  Colour skin = low + (high - low) * SmoothStep(0.0, 1.9, p.y());
  const auto d = model.PartDistances(p);
  const auto share = [&d](DragonletPart part, double softness) {
    double others = 1e9;
    for (int i = 0; i < kNumDragonletParts; ++i) {
      if (i != static_cast<int>(part)) others = std::min(others, d[i]);
    }
    return Inside(d[static_cast<int>(part)] - others, softness);
  };
  PaintSpots(p, &skin);
  const double core = std::min(d[0], d[1]);
  if (core < 0.1 && p.y() < 0.95) {
    Colour trunk = skin;
    PaintBelly(p, &trunk);
    Cover(trunk, 1 - share(DragonletPart::kFoot, 0.02), &skin);
  }
  if (core < 0.12 && p.y() > 0.8) PaintFace(model, p, &skin);
  const double limb_here[] = {share(DragonletPart::kTail, 0.1), share(DragonletPart::kEar, 0.05),
                              share(DragonletPart::kFoot, 0.05)};
  if (limb_here[0] > 0) PaintTail(model, p, &skin);
  if (limb_here[1] > 0) PaintEar(model, p, &skin);
  if (limb_here[2] > 0) PaintFoot(p, &skin);
  Colour horn = Hex(0xFFE3A3);
  Cover(Hex(0xFFB347), SmoothStep(1.82, 1.96, p.y()), &horn);
  Cover(horn, share(DragonletPart::kHorn, 0.015), &skin);
  Cover(Hex(0xFF8A5B), share(DragonletPart::kRidge, 0.015), &skin);
  return skin;
}

Colour DragonletEyeColour(const Vector3d& d) {
  const Vector2d at(d.x(), d.y());
  Colour eye = Hex(0xFFFDF6);
  Cover(Hex(0xBFD9DE), 0.7 * SmoothStep(0.35, 1.0, d.y()), &eye);  // the lid's shade
  if (d.z() <= 0) return eye;
  const Vector2d iris_at(0, -0.02);
  const double iris = (at - iris_at).norm() - 0.68;
  Colour iris_colour = Hex(0x6B3FA0);
  Cover(Hex(0xFF9F5A), SmoothStep(0.0, 0.7, -d.y()), &iris_colour);
  Cover(Hex(0x2A1642), SmoothStep(-0.12, 0.0, iris), &iris_colour);
  Cover(iris_colour, Inside(iris, 0.03), &eye);
  Cover(Hex(0x1B0F2B), Inside((at - iris_at).norm() - 0.44, 0.05), &eye);
  Cover(Hex(0xFFFFFF), Inside((at - Vector2d(-0.24, 0.3)).norm() - 0.2, 0.04), &eye);
  Cover(Hex(0xFFFFFF), 0.9 * Inside((at - Vector2d(0.26, -0.3)).norm() - 0.09, 0.04), &eye);
  return eye;
}

}  // namespace limber::content
