// Colours that can be read: lighter is more, and kinds differ.
#include "inspect/data_colors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::inspect {
namespace {

double Luminance(const Color& color) {
  return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

double Distance(const Color& a, const Color& b) {
  const auto x = ToBytes(a), y = ToBytes(b);
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

TEST(ScaleColor, MoreIsLighter_InGreyToo) {
  for (int i = 0; i < 100; ++i)
    EXPECT_LT(Luminance(ScaleColor(i / 100.0)), Luminance(ScaleColor((i + 1) / 100.0))) << i;
  EXPECT_EQ(ScaleColor(-3), ScaleColor(0));
  EXPECT_EQ(ScaleColor(7), ScaleColor(1));
  const Color low = ScaleColor(0), high = ScaleColor(1);
  EXPECT_GT(low[2], 2 * low[0]) << "blue";
  EXPECT_GT(std::min(high[0], high[1]), 1.5 * high[2]) << "yellow";
}

TEST(ScaleStrip, IsTheScaleWithALineAtEachTenth) {
  const viewer::Image strip = ScaleStrip();
  ASSERT_EQ(strip.height, 1u);
  int lines = 0;
  bool in_line = false;
  for (uint32_t x = 0; x < strip.width; ++x) {
    const auto plain = ToBytes(ScaleColor((x + 0.5) / strip.width));
    const bool is_plain = std::equal(plain.begin(), plain.end(), strip.pixel(x, 0));
    if (!is_plain && !in_line) {
      ++lines;
      const double value = (x + 0.5) / strip.width;
      EXPECT_NEAR(value * 10, std::round(value * 10), 0.05);
    }
    in_line = !is_plain;
  }
  EXPECT_EQ(lines, 9);
}

TEST(Palette, NoTwoOfTwentyLookAlike) {
  const std::vector<Color> colors = Palette(20);
  ASSERT_EQ(colors.size(), 20u);
  for (size_t a = 0; a < colors.size(); ++a) {
    for (size_t b = 0; b < a; ++b)
      EXPECT_GT(Distance(colors[a], colors[b]), 18) << a << " and " << b;
  }
  for (size_t a = 1; a < colors.size(); ++a)
    EXPECT_GT(Distance(colors[a], colors[a - 1]), 80) << "neighbours in number, " << a;
}

TEST(ToBytes, IsTheSrgbCode) {
  EXPECT_EQ(ToBytes({0, 1, 0.2158605}), (std::array<uint8_t, 4>{0, 255, 128, 255}));
  EXPECT_EQ(ToBytes({-1, 2, 0.002}), (std::array<uint8_t, 4>{0, 255, 7, 255}));
}

}  // namespace
}  // namespace limber::inspect
