// What is added to a rendered picture: a legend, and many pictures on one sheet.
#pragma once

#include "viewer/image.h"

#include <span>

namespace limber::inspect {

// Stretches `legend` (one row of texels) over a band along the lower edge.
void DrawLegend(const viewer::Image& legend, viewer::Image* picture);

// Pictures of one size side by side, row by row, in a grid about as wide as high. At least one.
viewer::Image ContactSheet(std::span<const viewer::Image> pictures);

}  // namespace limber::inspect
