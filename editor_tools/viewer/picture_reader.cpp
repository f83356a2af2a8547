#include "viewer/picture_reader.h"

#include <cstring>

namespace limber::viewer {

Status PictureReader::Create(const VulkanDevice& device, VkExtent2D extent) {
  extent_ = extent;
  return pixels_.Create(device.api(), VkDeviceSize{extent.width} * extent.height * 4,
                        VK_BUFFER_USAGE_TRANSFER_DST_BIT, kReadbackMemory);
}

void PictureReader::Record(VkCommandBuffer commands, VkImage picture) const {
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {extent_.width, extent_.height, 1};
  vkCmdCopyImageToBuffer(commands, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels_.handle(),
                         1, &copy);
  auto barrier = VulkanInfo<VkBufferMemoryBarrier>(VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.buffer = pixels_.handle();
  barrier.size = VK_WHOLE_SIZE;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 0,
                       nullptr, 1, &barrier, 0, nullptr);
}

void PictureReader::Read(Image* image) const {
  image->width = extent_.width;
  image->height = extent_.height;
  image->rgba.resize(size_t{extent_.width} * extent_.height * 4);
  std::memcpy(image->rgba.data(), pixels_.mapped(), image->rgba.size());
}

}  // namespace limber::viewer
