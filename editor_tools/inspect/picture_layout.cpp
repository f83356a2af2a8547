#include "inspect/picture_layout.h"

#include <algorithm>
#include <cmath>

namespace limber::inspect {
namespace {

constexpr uint32_t kBandShare = 30;  // of the picture's height
constexpr uint32_t kLeastBand = 6;

}  // namespace

void DrawLegend(const viewer::Image& legend, viewer::Image* picture) {
  const uint32_t band =
      std::min(picture->height, std::max(kLeastBand, picture->height / kBandShare));
  for (uint32_t y = picture->height - band; y < picture->height; ++y) {
    for (uint32_t x = 0; x < picture->width; ++x) {
      const auto texel = static_cast<uint32_t>(uint64_t{x} * legend.width / picture->width);
      std::copy_n(legend.pixel(texel, 0), 4,
                  picture->rgba.data() + (size_t{y} * picture->width + x) * 4);
    }
  }
}

viewer::Image ContactSheet(std::span<const viewer::Image> pictures) {
  const auto columns = static_cast<uint32_t>(std::ceil(std::sqrt(pictures.size())));
  const auto rows = static_cast<uint32_t>((pictures.size() + columns - 1) / columns);
  const uint32_t width = pictures[0].width, height = pictures[0].height;
  viewer::Image sheet{columns * width, rows * height, {}};
  sheet.rgba.assign(size_t{sheet.width} * sheet.height * 4, 255);
  for (size_t i = 0; i < pictures.size(); ++i) {
    const size_t left = i % columns * width, top = i / columns * height;
    for (uint32_t y = 0; y < height; ++y) {
      std::copy_n(pictures[i].pixel(0, y), size_t{width} * 4,
                  sheet.rgba.data() + ((top + y) * sheet.width + left) * 4);
    }
  }
  return sheet;
}

}  // namespace limber::inspect
