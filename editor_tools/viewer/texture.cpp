#include "viewer/texture.h"

#include "core/vector.h"
#include "skin_vulkan/vulkan_buffer.h"

#include <stb_image.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace limber::viewer {
namespace {

constexpr int kMaxSide = STBI_MAX_DIMENSIONS;  // what stb_image is built with

// Linear light of each sRGB code.
const std::array<float, 256>& LinearOfSrgb() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (size_t i = 0; i < values.size(); ++i) {
      const float c = static_cast<float>(i) / 255;
      values[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
    }
    return values;
  }();
  return table;
}

uint8_t SrgbOfLinear(float linear) {
  const float c =
      linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<uint8_t>(std::lround(std::clamp(c, 0.0f, 1.0f) * 255));
}

// The mean of one channel of four pixels, `code_is_srgb` in linear light.
uint8_t Mean(const std::array<const uint8_t*, 4>& pixels, size_t channel, bool code_is_srgb) {
  const auto& linear = LinearOfSrgb();
  float sum = 0;
  for (const uint8_t* pixel : pixels) {
    sum += code_is_srgb ? linear[pixel[channel]] : static_cast<float>(pixel[channel]);
  }
  return code_is_srgb ? SrgbOfLinear(sum / 4) : static_cast<uint8_t>(std::lround(sum / 4));
}

Vector<Image> MipChain(const Image& image, bool srgb) {
  Vector<Image> levels = {image};
  while (levels.back().width > 1 || levels.back().height > 1) {
    levels.push_back(HalfSize(levels.back(), srgb));
  }
  return levels;
}

void RecordUpload(VkCommandBuffer commands, VkBuffer from, VkImage to,
                  const Vector<VkBufferImageCopy>& copies) {
  VkImageMemoryBarrier to_write =
      LayoutChange(to, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  to_write.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                       0, 0, nullptr, 0, nullptr, 1, &to_write);
  vkCmdCopyBufferToImage(commands, from, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                         static_cast<uint32_t>(copies.size()), copies.data());
  VkImageMemoryBarrier to_read = LayoutChange(to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                              VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  to_read.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  to_read.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                       VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, 0, 0, nullptr, 0, nullptr, 1,
                       &to_read);
}

}  // namespace

Image HalfSize(const Image& from, bool srgb) {
  Image to;
  to.width = std::max(1u, from.width / 2);
  to.height = std::max(1u, from.height / 2);
  to.rgba.resize(size_t{to.width} * to.height * 4);
  uint8_t* out = to.rgba.data();
  for (uint32_t y = 0; y < to.height; ++y) {
    const uint32_t y1 = std::min(2 * y + 1, from.height - 1);
    for (uint32_t x = 0; x < to.width; ++x, out += 4) {
      const uint32_t x1 = std::min(2 * x + 1, from.width - 1);
      const std::array<const uint8_t*, 4> covered = {from.pixel(2 * x, 2 * y),
                                                     from.pixel(x1, 2 * y), from.pixel(2 * x, y1),
                                                     from.pixel(x1, y1)};
      for (size_t c = 0; c < 4; ++c)
        out[c] = Mean(covered, c, srgb && c < 3);
    }
  }
  return to;
}

Result<Image> DecodeImage(std::span<const uint8_t> encoded) {
  if (encoded.size() > (size_t{1} << 28)) {
    return Error(StatusCode::kLimitExceeded, "larger than 256 MiB");
  }
  const auto length = static_cast<int>(encoded.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(encoded.data(), length, &width, &height, &channels) == 0) {
    return Error(StatusCode::kUnsupported, "is neither PNG nor JPEG");
  }
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return Error(StatusCode::kLimitExceeded, "has %d x %d pixels, at most %d a side", width, height,
                 kMaxSide);
  }
  stbi_uc* pixels = stbi_load_from_memory(encoded.data(), length, &width, &height, &channels, 4);
  if (pixels == nullptr) return Error(StatusCode::kMalformed, "cannot be decoded");
  Image image;
  image.width = static_cast<uint32_t>(width);
  image.height = static_cast<uint32_t>(height);
  image.rgba.assign(pixels, pixels + size_t{image.width} * image.height * 4);
  stbi_image_free(pixels);
  return image;
}

Result<GpuImage> UploadTexture(VulkanDevice* device, const Image& image, bool srgb) {
  const Vector<Image> levels = MipChain(image, srgb);
  GpuImageOptions options;
  options.format = srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
  options.extent = {image.width, image.height};
  options.mip_levels = static_cast<uint32_t>(levels.size());
  options.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  GpuImage texture;
  LIMBER_RETURN_IF_ERROR(texture.Create(*device, options));

  BufferPlan plan(16);
  Vector<VkBufferImageCopy> copies;
  for (const Image& level : levels) {
    VkBufferImageCopy copy{};
    copy.bufferOffset = plan.Add(level.rgba.size()).offset;
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, static_cast<uint32_t>(copies.size()), 0, 1};
    copy.imageExtent = {level.width, level.height, 1};
    copies.push_back(copy);
  }
  VulkanBuffer staging;
  LIMBER_RETURN_IF_ERROR(
      staging.Create(device->api(), plan.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, kStagingMemory));
  for (size_t i = 0; i < levels.size(); ++i) {
    std::memcpy(staging.mapped() + copies[i].bufferOffset, levels[i].rgba.data(),
                levels[i].rgba.size());
  }
  LIMBER_RETURN_IF_ERROR(device->SubmitAndWait([&](VkCommandBuffer commands) {
    RecordUpload(commands, staging.handle(), texture.handle(), copies);
  }));
  return texture;
}

}  // namespace limber::viewer
