#include "inspect/picture_layout.h"

#include "viewer/texture.h"

#include <algorithm>
#include <cmath>

namespace limber::inspect {
namespace {

constexpr uint32_t kBandShare = 30;  // of the picture's height
constexpr uint32_t kLeastBand = 6;
constexpr uint64_t kMaxSheetSide = 4096;

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

ContactSheet::ContactSheet(size_t count, uint32_t width, uint32_t height)
    : columns_(static_cast<uint32_t>(std::ceil(std::sqrt(count)))) {
  const auto rows = static_cast<uint32_t>((count + columns_ - 1) / columns_);
  const auto too_large = [&] {
    return std::max(uint64_t{columns_} * width, uint64_t{rows} * height) > kMaxSheetSide;
  };
  for (; too_large() && std::max(width, height) > 1; ++num_halvings_) {
    width = std::max(1u, width / 2);  // what HalfSize makes of it
    height = std::max(1u, height / 2);
  }
  width_ = width;
  height_ = height;
  sheet_.width = columns_ * width;
  sheet_.height = rows * height;
  sheet_.rgba.assign(size_t{sheet_.width} * sheet_.height * 4, 255);
}

void ContactSheet::Add(viewer::Image picture) {
  for (int i = 0; i < num_halvings_; ++i)
    picture = viewer::HalfSize(picture, true);
  const size_t left = num_added_ % columns_ * width_, top = num_added_ / columns_ * height_;
  for (uint32_t y = 0; y < height_; ++y) {
    std::copy_n(picture.pixel(0, y), size_t{width_} * 4,
                sheet_.rgba.data() + ((top + y) * sheet_.width + left) * 4);
  }
  ++num_added_;
}

}  // namespace limber::inspect
