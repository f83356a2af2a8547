// Decoding of image files, and textures with mipmaps on the device.
#pragma once

#include "core/status.h"
#include "viewer/gpu_image.h"
#include "viewer/image.h"

#include <cstdint>
#include <span>

namespace limber::viewer {

// PNG or JPEG, at most 8192 pixels a side. Errors: kMalformed, kLimitExceeded, kUnsupported.
Result<Image> DecodeImage(std::span<const uint8_t> encoded);

// Half the size (rounded down, at least 1), each pixel the mean of the ones it covers, in linear
// light where `srgb`.
Image HalfSize(const Image& from, bool srgb);

// A sampled texture with a full chain of mipmaps, averaged in linear light where `srgb`.
// Waits for the upload. Errors: kDeviceError.
Result<GpuImage> UploadTexture(VulkanDevice* device, const Image& image, bool srgb);

}  // namespace limber::viewer
