#include "viewer/gpu_image.h"

#include "skin_vulkan/vulkan_buffer.h"

#include <utility>

namespace limber::viewer {

VkImageMemoryBarrier LayoutChange(VkImage image, VkImageLayout from, VkImageLayout to) {
  auto barrier = VulkanInfo<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0, 1};
  return barrier;
}

GpuImage& GpuImage::operator=(GpuImage&& other) noexcept {
  if (this == &other) return *this;
  Destroy();
  device_ = std::exchange(other.device_, VK_NULL_HANDLE);
  image_ = std::exchange(other.image_, VK_NULL_HANDLE);
  memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
  view_ = std::exchange(other.view_, VK_NULL_HANDLE);
  return *this;
}

void GpuImage::Destroy() {
  if (device_ == VK_NULL_HANDLE) return;
  vkDestroyImageView(device_, view_, nullptr);
  vkDestroyImage(device_, image_, nullptr);
  vkFreeMemory(device_, memory_, nullptr);
  device_ = VK_NULL_HANDLE;
}

Status GpuImage::Create(const VulkanDevice& device, const GpuImageOptions& options) {
  GpuImage image;  // freed on the way out of an error
  *this = GpuImage();
  image.device_ = device.handle();
  auto info = VulkanInfo<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = options.format;
  info.extent = {options.extent.width, options.extent.height, 1};
  info.mipLevels = options.mip_levels;
  info.arrayLayers = 1;
  info.samples = options.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = options.usage;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(vkCreateImage(image.device_, &info, nullptr, &image.image_), "vkCreateImage"));
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(image.device_, image.image_, &needs);
  auto allocate = VulkanInfo<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  LIMBER_RETURN_IF_ERROR(ChooseMemoryType(device.api(), needs.memoryTypeBits, kDeviceMemory,
                                          &allocate.memoryTypeIndex));
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      vkAllocateMemory(image.device_, &allocate, nullptr, &image.memory_), "vkAllocateMemory"));
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      vkBindImageMemory(image.device_, image.image_, image.memory_, 0), "vkBindImageMemory"));

  auto view = VulkanInfo<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  view.image = image.image_;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = options.format;
  view.subresourceRange = {options.aspect, 0, options.mip_levels, 0, 1};
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      vkCreateImageView(image.device_, &view, nullptr, &image.view_), "vkCreateImageView"));
  *this = std::move(image);
  return {};
}

}  // namespace limber::viewer
