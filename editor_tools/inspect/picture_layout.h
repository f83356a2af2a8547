// What is added to a rendered picture: a legend, and many pictures on one sheet.
#pragma once

#include "viewer/image.h"

#include <cstddef>

namespace limber::inspect {

// Stretches `legend` (one row of texels) over a band along the lower edge.
void DrawLegend(const viewer::Image& legend, viewer::Image* picture);

// Pictures of one size side by side, row by row, in a grid as many wide as high or one more. What
// is left of the last row is white.
class ContactSheet {
 public:
  // For `count` pictures (at least one) of this size, each halved until the sheet has at most 4096
  // pixels a side (or they have but one).
  ContactSheet(size_t count, uint32_t width, uint32_t height);

  // The next one; at most `count` times.
  void Add(viewer::Image picture);

  const viewer::Image& image() const { return sheet_; }

 private:
  uint32_t width_, height_, columns_;  // of a picture on the sheet; of the grid
  int num_halvings_ = 0;
  size_t num_added_ = 0;
  viewer::Image sheet_;
};

}  // namespace limber::inspect
