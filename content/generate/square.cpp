#include "generate/square.h"

#include "generate/canvas.h"
#include "generate/drag.h"
#include "generate/shaping.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace limber::content {
namespace {

constexpr int kQuads = 20, kPixels = 512;

// Soft tiles in two tones of one gradient, with a frame around them.
Colour Tiles(double px, double py) {
  const double x = px / kPixels, y = py / kPixels;
  const Colour top_left = Hex(0xFFC857), bottom_right = Hex(0xF25F7A), cream = Hex(0xFFF6E6);
  Colour colour = top_left + (bottom_right - top_left) * ((x + y) / 2);
  const double u = 10 * x, v = 10 * y;
  const bool light = (static_cast<int>(u) + static_cast<int>(v)) % 2 == 0;
  const Vector2d in_tile(u - std::floor(u) - 0.5, v - std::floor(v) - 0.5);
  const Vector2d beyond = (in_tile.cwiseAbs() - Vector2d::Constant(0.26)).cwiseMax(0);
  const double tile = Inside(beyond.norm() - 0.16, 0.04);
  Cover(light ? cream : Hex(0x7A2E5D), (light ? 0.55 : 0.16) * tile, &colour);
  const double edge = std::min(std::min(x, 1 - x), std::min(y, 1 - y));
  Cover(Hex(0x5B2245), Inside(edge - 0.012, 0.006), &colour);
  return colour;
}

struct SquareGesture {
  const char* name;
  double width, swell;
};

constexpr SquareGesture kGestures[] = {{"puffed", 1.6, 0.5}, {"thinned", 2.4, -0.5}};

SpaceWarp PoseSquare(const GestureMix& mix) {
  double width = 1, swell = 0;
  for (const SquareGesture& gesture : kGestures) {
    const double amount = AmountOf(gesture.name, mix);
    width += amount * (gesture.width - 1);
    swell += amount * gesture.swell;
  }
  return [width, swell](const Vector3d& p) {
    const double bulge = 1 + swell * std::sin(std::numbers::pi * p.x());
    return Vector3d(width * p.x(), bulge * p.y(), 0);
  };
}

}  // namespace

Character MakeSquare() {
  Character square;
  square.name = "square";
  Shape rest{"square", {}};
  Primitive primitive;
  const int row = kQuads + 1;
  for (int y = 0; y <= kQuads; ++y) {
    for (int x = 0; x <= kQuads; ++x) {
      const Vector2d at(double(x) / kQuads, double(y) / kQuads);
      rest.positions.emplace_back(at.x(), at.y() - 0.5, 0);
      square.normals.emplace_back(0, 0, 1);
      square.texcoords.emplace_back(at.x(), 1 - at.y());
    }
  }
  for (int y = 0; y < kQuads; ++y) {
    for (int x = 0; x < kQuads; ++x) {
      const auto a = static_cast<uint32_t>(y * row + x), b = a + 1, c = a + row, d = c + 1;
      // Diagonals mirror at the middle lines, so that the mesh favours no side.
      const bool rising = (x < kQuads / 2) == (y < kQuads / 2);
      const std::vector<uint32_t> pair = rising ? std::vector<uint32_t>{a, b, d, a, d, c}
                                                : std::vector<uint32_t>{a, b, c, b, d, c};
      primitive.triangles.insert(primitive.triangles.end(), pair.begin(), pair.end());
    }
  }
  primitive.num_vertices = static_cast<uint32_t>(rest.positions.size());
  square.primitives = {primitive};
  square.shapes = {rest};
  for (const SquareGesture& gesture : kGestures) {
    const SpaceWarp pose = PoseSquare({{gesture.name, 1}});
    Shape shape{gesture.name, {}};
    for (const Vector3d& p : rest.positions)
      shape.positions.push_back(pose(p));
    square.shapes.push_back(std::move(shape));
  }
  square.materials = {{.name = "tiles", .double_sided = true}};
  square.picture = Paint(kPixels, kPixels, 3, Tiles);
  const auto middle = static_cast<uint32_t>(kQuads / 2 * row);
  square.handles = {{"left", middle, true},
                    {"centre", middle + kQuads / 2, false},
                    {"right", middle + kQuads, true}};
  RoundPositions(&square);
  return square;
}

std::string MakeSquareDrag(const Character& square) {
  return WriteDrag(square, PoseSquare,
                   {{{{"puffed", 1}}, 18},
                    {{{"thinned", 1}}, 20},
                    {{{"thinned", 1.15}}, 10},
                    {{{"puffed", 1}}, 22},
                    {{}, 20}});
}

}  // namespace limber::content
