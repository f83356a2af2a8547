// A buffer with its own memory, freed with it. One buffer holds several ranges (BufferPlan), so
// that a character needs two allocations and not dozens.
#pragma once

#include "skin_vulkan/vulkan_api.h"

#include <memory>
#include <vector>

namespace limber {

struct BufferRange {
  VkDeviceSize offset = 0, size = 0;
};

// Lays ranges one after the other, each at a multiple of `alignment` (a power of two).
class BufferPlan {
 public:
  explicit BufferPlan(VkDeviceSize alignment) : alignment_(alignment) {}

  // A range of `bytes`; sizes are those of checked tables, so sums stay far below 2^64.
  BufferRange Add(VkDeviceSize bytes);

  VkDeviceSize size() const { return end_; }

 private:
  VkDeviceSize alignment_, end_ = 0;
};

class VulkanBuffer {
 public:
  VulkanBuffer() = default;

  VulkanBuffer(VulkanBuffer&& other) noexcept { *this = std::move(other); }

  VulkanBuffer& operator=(VulkanBuffer&& other) noexcept;

  ~VulkanBuffer() { Destroy(); }

  // The first memory type that has `required` and, if there is one, also `preferred` flags.
  // Host-visible memory is mapped for the buffer's life. `api` must outlive the buffer.
  // Errors: kDeviceError.
  static Result<VulkanBuffer> Create(const VulkanApi& api, VkDeviceSize size,
                                     VkBufferUsageFlags usage, VkMemoryPropertyFlags required,
                                     VkMemoryPropertyFlags preferred);

  VkBuffer handle() const { return buffer_; }

  VkDeviceSize size() const { return size_; }

  // Null where the memory is not host-visible.
  std::byte* mapped() const { return mapped_; }

  // Makes host writes visible to later submissions; free on coherent memory.
  Status Flush() const;

 private:
  void Destroy();

  const VulkanApi* api_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkDeviceSize size_ = 0;
  std::byte* mapped_ = nullptr;
  bool coherent_ = true;
};

}  // namespace limber
