// An image with its own memory and one view, freed with it.
#pragma once

#include "viewer/device.h"

namespace limber::viewer {

struct GpuImageOptions {
  VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  VkExtent2D extent{1, 1};
  uint32_t mip_levels = 1;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT;
  VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
};

// All of an image's mipmaps, from one layout to another; the caller adds the accesses.
VkImageMemoryBarrier LayoutChange(VkImage image, VkImageLayout from, VkImageLayout to);

class GpuImage {
 public:
  GpuImage() = default;

  GpuImage(GpuImage&& other) noexcept { *this = std::move(other); }

  GpuImage& operator=(GpuImage&& other) noexcept;

  ~GpuImage() { Destroy(); }

  // Makes the image anew, device-local; what it held before is freed, and after an error it is
  // empty. `device` must outlive the image. Errors: kDeviceError.
  Status Create(const VulkanDevice& device, const GpuImageOptions& options);

  VkImage handle() const { return image_; }

  VkImageView view() const { return view_; }

 private:
  void Destroy();

  VkDevice device_ = VK_NULL_HANDLE;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
};

}  // namespace limber::viewer
