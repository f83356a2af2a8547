#include "viewer/image.h"

#include <png.h>

#include <string>
#include <system_error>

namespace limber::viewer {
namespace {

constexpr uint32_t kMaxSide = 16384;

}  // namespace

Status WritePng(const std::filesystem::path& path, const Image& image) {
  if (image.width == 0 || image.height == 0 ||
      image.rgba.size() != size_t{image.width} * image.height * 4) {
    return Error(StatusCode::kInvalidArgument, "%s: the picture has %u x %u pixels and %zu bytes",
                 path.string().c_str(), image.width, image.height, image.rgba.size());
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  png.format = PNG_FORMAT_RGBA;
  png.flags = PNG_IMAGE_FLAG_FAST;
  const std::filesystem::path beside = path.string() + ".part";
  std::error_code error;
  if (png_image_write_to_file(&png, beside.c_str(), 0, image.rgba.data(), 0, nullptr) == 0) {
    std::filesystem::remove(beside, error);
    return Error(StatusCode::kIoError, "%s: cannot be written: %s", path.string().c_str(),
                 png.message);
  }
  std::filesystem::rename(beside, path, error);
  if (!error) return {};
  const std::string reason = error.message();
  std::filesystem::remove(beside, error);
  return Error(StatusCode::kIoError, "%s: cannot be written: %s", path.string().c_str(),
               reason.c_str());
}

Result<Image> ReadPng(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return Error(StatusCode::kNotFound, "%s: no such file", path.string().c_str());
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&png, path.c_str()) == 0) {
    return Error(StatusCode::kMalformed, "%s: not a PNG: %s", path.string().c_str(), png.message);
  }
  if (png.width > kMaxSide || png.height > kMaxSide) {
    png_image_free(&png);
    return Error(StatusCode::kLimitExceeded, "%s: %u x %u pixels, at most %u a side",
                 path.string().c_str(), png.width, png.height, kMaxSide);
  }
  png.format = PNG_FORMAT_RGBA;
  Image image;
  image.width = png.width;
  image.height = png.height;
  image.rgba.resize(size_t{png.width} * png.height * 4);
  if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0) {
    return Error(StatusCode::kMalformed, "%s: broken PNG: %s", path.string().c_str(), png.message);
  }
  return image;
}

}  // namespace limber::viewer
