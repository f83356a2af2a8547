#include "inspect/data_colors.h"

#include "core/vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::inspect {
namespace {

constexpr uint32_t kStripWidth = 1024;
constexpr int kContours = 10;
constexpr double kContourHalfWidth = 0.004, kContourDarkness = 0.45;

Color ToLinear(const Oklab& lab) {
  const double l = std::pow(lab.lightness + 0.3963377774 * lab.a + 0.2158037573 * lab.b, 3);
  const double m = std::pow(lab.lightness - 0.1055613458 * lab.a - 0.0638541728 * lab.b, 3);
  const double s = std::pow(lab.lightness - 0.0894841775 * lab.a - 1.2914855480 * lab.b, 3);
  const Color color = {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                       -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                       -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
  return {std::clamp(color[0], 0.0, 1.0), std::clamp(color[1], 0.0, 1.0),
          std::clamp(color[2], 0.0, 1.0)};
}

Oklab Polar(double lightness, double chroma, double hue_degrees) {
  const double hue = hue_degrees * std::numbers::pi / 180;
  return {lightness, chroma * std::cos(hue), chroma * std::sin(hue)};
}

uint8_t Encoded(double linear) {
  const double code =
      linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<uint8_t>(std::lround(255 * std::clamp(code, 0.0, 1.0)));
}

double ValueOfTexel(uint32_t x) {
  return (x + 0.5) / kStripWidth;
}

}  // namespace

Oklab ToOklab(const Color& color) {
  const auto [red, green, blue] = color;
  const double l = std::cbrt(0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue);
  const double m = std::cbrt(0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue);
  const double s = std::cbrt(0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Color ScaleColor(double value) {
  const double at = std::clamp(value, 0.0, 1.0);
  // As much chroma as sRGB has all along this path: least at cyan, a little before the middle.
  const double chroma = 0.13 - 0.038 * std::sin(std::numbers::pi * at);
  return ToLinear(Polar(0.30 + 0.65 * at, chroma, 285 - 180 * at));
}

Vector<Color> Palette(int count) {
  constexpr double kGoldenAngle = 137.50776405;
  constexpr double kLevels[] = {0.72, 0.54, 0.86};
  Vector<Color> colors;
  colors.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i)
    colors.push_back(ToLinear(Polar(kLevels[i % 3], 0.13, 25 + kGoldenAngle * i)));
  return colors;
}

Vector<Color> ExampleColors(int count) {
  Vector<Color> colors = Palette(std::max(count - 1, 0));
  if (count > 0) colors.insert(colors.begin(), ToLinear({0.75, 0, 0}));
  return colors;
}

std::array<uint8_t, 4> ToBytes(const Color& color) {
  return {Encoded(color[0]), Encoded(color[1]), Encoded(color[2]), 255};
}

viewer::Image ScaleStrip() {
  Vector<Color> colors;
  for (uint32_t x = 0; x < kStripWidth; ++x)
    colors.push_back(ScaleColor(ValueOfTexel(x)));
  return Swatches(colors);
}

viewer::Image ScaleLegend() {
  Vector<Color> colors;
  for (uint32_t x = 0; x < kStripWidth; ++x) {
    const double value = ValueOfTexel(x);
    const double tenth = std::round(value * kContours) / kContours;
    const bool is_line = tenth > 0 && tenth < 1 && std::abs(value - tenth) < kContourHalfWidth;
    Color color = ScaleColor(value);
    for (double& channel : color)
      channel *= is_line ? kContourDarkness : 1;
    colors.push_back(color);
  }
  return Swatches(colors);
}

viewer::Image Swatches(const Vector<Color>& colors) {
  viewer::Image image;
  image.width = static_cast<uint32_t>(colors.size());
  image.height = 1;
  for (const Color& color : colors) {
    const auto bytes = ToBytes(color);
    image.rgba.insert(image.rgba.end(), bytes.begin(), bytes.end());
  }
  return image;
}

}  // namespace limber::inspect
