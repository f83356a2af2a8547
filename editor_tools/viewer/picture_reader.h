// A drawn picture's way back to main memory.
#pragma once

#include "skin_vulkan/vulkan_buffer.h"
#include "viewer/device.h"
#include "viewer/image.h"

namespace limber::viewer {

class PictureReader {
 public:
  // For pictures of this size. `device` must outlive the reader. Errors: kDeviceError.
  Status Create(const VulkanDevice& device, VkExtent2D extent);

  // Records the copy of `picture` (of the size given to Create, R8G8B8A8, in layout
  // TRANSFER_SRC_OPTIMAL, written before), outside a render pass.
  void Record(VkCommandBuffer commands, VkImage picture) const;

  // The picture, once the recorded commands have finished. `image` is resized as needed.
  void Read(Image* image) const;

 private:
  VkExtent2D extent_{0, 0};
  VulkanBuffer pixels_;
};

}  // namespace limber::viewer
