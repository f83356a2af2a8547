#include "viewer/gpu_image.h"

#include <utility>

namespace limber::viewer {
namespace {

// Device-local if there is such a type, otherwise any that the image allows.
uint32_t ChooseMemoryType(const VkPhysicalDeviceMemoryProperties& memory, uint32_t allowed) {
  uint32_t any = 0;
  for (uint32_t i = memory.memoryTypeCount; i-- > 0;) {
    if ((allowed >> i & 1) != 0) any = i;
  }
  for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((allowed >> i & 1) != 0 &&
        (memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0) {
      return i;
    }
  }
  return any;
}

}  // namespace

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

Result<GpuImage> GpuImage::Create(const VulkanDevice& device, const GpuImageOptions& options) {
  GpuImage image;
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
  allocate.memoryTypeIndex = ChooseMemoryType(device.api().memory, needs.memoryTypeBits);
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
  return image;
}

}  // namespace limber::viewer
