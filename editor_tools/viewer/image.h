// Pictures in main memory, and as PNG files.
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <cstdint>
#include <filesystem>

namespace limber::viewer {

// Rows from the top, four bytes a pixel: red, green, blue, alpha; sRGB.
struct Image {
  uint32_t width = 0, height = 0;
  Vector<uint8_t> rgba;

  const uint8_t* pixel(uint32_t x, uint32_t y) const {
    return rgba.data() + (size_t{y} * width + x) * 4;
  }
};

// Writes beside and renames, so that no half-written file is left. Errors: kIoError.
Status WritePng(const std::filesystem::path& path, const Image& image);
// At most 16384 pixels a side. Errors: kNotFound, kMalformed.
Result<Image> ReadPng(const std::filesystem::path& path);

}  // namespace limber::viewer
