// Colours that carry numbers: a scale for values from 0 to 1, and palettes for kinds.
#pragma once

#include "viewer/image.h"

#include <array>
#include <vector>

namespace limber::inspect {

using Color = std::array<double, 3>;  // linear red, green, blue, 0 to 1

// From dark blue over green to pale yellow, in even steps of perceived lightness (Oklab, Ottosson
// 2020), so that it reads in grey and to colour-blind eyes too. value is clamped to 0..1.
Color ScaleColor(double value);

// `count` colours as far from each other as can be told at a glance: hues by the golden angle,
// three levels of lightness in turn.
std::vector<Color> Palette(int count);

// The scale as a strip for texture coordinates u = value, with a thin dark line at each tenth: the
// contours of the value on the surface.
viewer::Image ScaleStrip();

// One texel a colour, in a row.
viewer::Image Swatches(const std::vector<Color>& colors);

// Four bytes, sRGB.
std::array<uint8_t, 4> ToBytes(const Color& color);

}  // namespace limber::inspect
