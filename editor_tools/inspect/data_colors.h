// Colours that carry numbers: a scale for values from 0 to 1, and palettes for kinds.
//
// Laid out in Oklab (Ottosson 2020, A perceptual color space for image processing), where equal
// distances look about equally different.
#pragma once

#include "core/vector.h"
#include "viewer/image.h"

#include <array>

namespace limber::inspect {

using Color = std::array<double, 3>;  // linear red, green, blue, 0 to 1

struct Oklab {
  double lightness = 0, a = 0, b = 0;  // lightness 0 to 1; a: green to red, b: blue to yellow
};

Oklab ToOklab(const Color& color);

// From indigo over green to pale yellow, lightness in proportion to the value, so that it reads in
// grey and to colour-blind eyes too. value is clamped to 0..1.
Color ScaleColor(double value);

// `count` colours as far from each other as can be told at a glance: hues by the golden angle,
// three levels of lightness in turn.
Vector<Color> Palette(int count);

// One for each example shape: the first, which a character at rest shows, in grey, so that colour
// tells where others take part; those in a palette.
Vector<Color> ExampleColors(int count);

// The scale as a strip for texture coordinates u = value.
viewer::Image ScaleStrip();

// The scale as a legend, with a dark line at each tenth as the surface has them.
viewer::Image ScaleLegend();

// One texel a colour, in a row.
viewer::Image Swatches(const Vector<Color>& colors);

// Four bytes, sRGB.
std::array<uint8_t, 4> ToBytes(const Color& color);

}  // namespace limber::inspect
