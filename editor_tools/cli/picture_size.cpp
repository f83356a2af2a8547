#include "cli/picture_size.h"

#include <cstdio>

namespace limber::cli {

std::string ParseSize(const std::string& text, uint32_t* width, uint32_t* height) {
  constexpr unsigned kLargestSide = 8192;
  unsigned w = 0, h = 0;
  char rest = 0;
  const bool two = std::sscanf(text.c_str(), "%5ux%5u%c", &w, &h, &rest) == 2;
  if (!two || w < 1 || h < 1 || w > kLargestSide || h > kLargestSide) {
    return "--size " + text + ": WxH is needed, as in 1280x720, each at most 8192";
  }
  *width = w;
  *height = h;
  return "";
}

}  // namespace limber::cli
