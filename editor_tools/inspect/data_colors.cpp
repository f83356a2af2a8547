#include "inspect/data_colors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::inspect {
namespace {

constexpr uint32_t kStripWidth = 1024;
constexpr int kContours = 10;
constexpr double kContourHalfWidth = 0.004, kContourDarkness = 0.45;

struct Lab {
  double lightness, a, b;
};

Color ToLinear(const Lab& lab) {
  const double l = std::pow(lab.lightness + 0.3963377774 * lab.a + 0.2158037573 * lab.b, 3);
  const double m = std::pow(lab.lightness - 0.1055613458 * lab.a - 0.0638541728 * lab.b, 3);
  const double s = std::pow(lab.lightness - 0.0894841775 * lab.a - 1.2914855480 * lab.b, 3);
  const Color color = {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                       -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                       -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
  return {std::clamp(color[0], 0.0, 1.0), std::clamp(color[1], 0.0, 1.0),
          std::clamp(color[2], 0.0, 1.0)};
}

Lab Polar(double lightness, double chroma, double hue_degrees) {
  const double hue = hue_degrees * std::numbers::pi / 180;
  return {lightness, chroma * std::cos(hue), chroma * std::sin(hue)};
}

uint8_t Encoded(double linear) {
  const double code =
      linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<uint8_t>(std::lround(255 * std::clamp(code, 0.0, 1.0)));
}

}  // namespace

Color ScaleColor(double value) {
  const double at = std::clamp(value, 0.0, 1.0);
  // Hue from blue (265) to yellow (105); chroma fades where screens have little of it.
  return ToLinear(
      Polar(0.30 + 0.65 * at, 0.11 + 0.05 * std::sin(std::numbers::pi * at), 265 - 160 * at));
}

std::vector<Color> Palette(int count) {
  constexpr double kGoldenAngle = 137.50776405;
  constexpr double kLevels[] = {0.72, 0.54, 0.86};
  std::vector<Color> colors;
  colors.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i)
    colors.push_back(ToLinear(Polar(kLevels[i % 3], 0.13, 25 + kGoldenAngle * i)));
  return colors;
}

std::array<uint8_t, 4> ToBytes(const Color& color) {
  return {Encoded(color[0]), Encoded(color[1]), Encoded(color[2]), 255};
}

viewer::Image ScaleStrip() {
  viewer::Image image;
  image.width = kStripWidth;
  image.height = 1;
  for (uint32_t x = 0; x < kStripWidth; ++x) {
    const double value = (x + 0.5) / kStripWidth;
    const double tenth = std::round(value * kContours) / kContours;
    const bool is_line = tenth > 0 && tenth < 1 && std::abs(value - tenth) < kContourHalfWidth;
    Color color = ScaleColor(value);
    for (double& channel : color)
      channel *= is_line ? kContourDarkness : 1;
    const auto bytes = ToBytes(color);
    image.rgba.insert(image.rgba.end(), bytes.begin(), bytes.end());
  }
  return image;
}

viewer::Image Swatches(const std::vector<Color>& colors) {
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
