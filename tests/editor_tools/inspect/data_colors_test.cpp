// Colours that can be read: lighter is more, and kinds differ.
#include "inspect/data_colors.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace limber::inspect {
namespace {

double Distance(const Color& a, const Color& b) {
  const auto x = ToBytes(a), y = ToBytes(b);
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

// Two ways round: the scale is made from Oklab, and taken back to it. A channel that left what a
// screen has would be cut and break the proportion.
TEST(ScaleColor, LightnessIsInProportionToTheValue) {
  const double low = ToOklab(ScaleColor(0)).lightness, high = ToOklab(ScaleColor(1)).lightness;
  EXPECT_GT(high - low, 0.6);
  for (int i = 0; i <= 100; ++i) {
    const double value = i / 100.0;
    EXPECT_NEAR(ToOklab(ScaleColor(value)).lightness, low + value * (high - low), 1e-4) << value;
  }
  EXPECT_EQ(ScaleColor(-3), ScaleColor(0));
  EXPECT_EQ(ScaleColor(7), ScaleColor(1));
}

TEST(ScaleColor, RunsFromBlueToYellow) {
  const Color low = ScaleColor(0), high = ScaleColor(1);
  EXPECT_GT(low[2], 2 * low[0]) << "blue";
  EXPECT_GT(std::min(high[0], high[1]), 1.5 * high[2]) << "yellow";
}

TEST(ScaleStrip, IsTheScale) {
  const viewer::Image strip = ScaleStrip();
  ASSERT_EQ(strip.height, 1u);
  for (uint32_t x = 0; x < strip.width; ++x) {
    const auto plain = ToBytes(ScaleColor((x + 0.5) / strip.width));
    EXPECT_TRUE(std::equal(plain.begin(), plain.end(), strip.pixel(x, 0))) << x;
  }
}

TEST(ScaleLegend, IsTheScaleWithALineAtEachTenth) {
  const viewer::Image strip = ScaleStrip(), legend = ScaleLegend();
  ASSERT_EQ(legend.width, strip.width);
  int lines = 0;
  bool in_line = false;
  for (uint32_t x = 0; x < strip.width; ++x) {
    const bool is_plain = std::equal(strip.pixel(x, 0), strip.pixel(x, 0) + 4, legend.pixel(x, 0));
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
  const Vector<Color> colors = Palette(20);
  ASSERT_EQ(colors.size(), 20u);
  for (size_t a = 0; a < colors.size(); ++a) {
    for (size_t b = 0; b < a; ++b)
      EXPECT_GT(Distance(colors[a], colors[b]), 18) << a << " and " << b;
  }
  for (size_t a = 1; a < colors.size(); ++a)
    EXPECT_GT(Distance(colors[a], colors[a - 1]), 80) << "neighbours in number, " << a;
}

TEST(ExampleColors, TheFirstIsGreyAndTheOthersAreNot) {
  for (const int count : {1, 2, 10}) {
    const Vector<Color> colors = ExampleColors(count);
    ASSERT_EQ(colors.size(), static_cast<size_t>(count));
    for (size_t s = 0; s < colors.size(); ++s) {
      const Oklab lab = ToOklab(colors[s]);
      if (s == 0) {
        EXPECT_LT(std::hypot(lab.a, lab.b), 0.001);
      } else {
        EXPECT_GT(std::hypot(lab.a, lab.b), 0.05) << s;
      }
    }
  }
  EXPECT_TRUE(ExampleColors(0).empty());
}

TEST(ToBytes, IsTheSrgbCode) {
  EXPECT_EQ(ToBytes({0, 1, 0.2158605}), (std::array<uint8_t, 4>{0, 255, 128, 255}));
  EXPECT_EQ(ToBytes({-1, 2, 0.002}), (std::array<uint8_t, 4>{0, 255, 7, 255}));
}

}  // namespace
}  // namespace limber::inspect
