// A buffer with its own memory, freed with it. One buffer holds several ranges (BufferPlan), so
// that a character needs two allocations and not dozens.
#pragma once

#include "skin_vulkan/vulkan_api.h"

#include <utility>

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

// Where a buffer lies: in the first memory type with all flags, otherwise in the first with the
// required ones. What the host writes or reads is coherent, which every device has: nothing needs
// to be flushed.
struct MemoryWish {
  VkMemoryPropertyFlags required = 0, preferred = 0;
};

// Read and written by the device alone.
inline constexpr MemoryWish kDeviceMemory{0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
// Written by the host, copied from by the device.
inline constexpr MemoryWish kStagingMemory{
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, 0};
// Written by the host, in order, and read by the device's shaders.
inline constexpr MemoryWish kUploadMemory{
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
    VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
// Written by the device, read by the host.
inline constexpr MemoryWish kReadbackMemory{
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
    VK_MEMORY_PROPERTY_HOST_CACHED_BIT};

// The index of the memory type for `wish` among those whose bits `allowed` has set.
// Errors: kDeviceError.
Status ChooseMemoryType(const VulkanApi& api, uint32_t allowed, const MemoryWish& wish,
                        uint32_t* type);

// Empty until Create; host-visible memory is mapped for the buffer's life. Memory comes from the
// host's allocator where there is one.
class VulkanBuffer {
 public:
  VulkanBuffer() = default;

  VulkanBuffer(VulkanBuffer&& other) noexcept { *this = std::move(other); }

  VulkanBuffer& operator=(VulkanBuffer&& other) noexcept;

  ~VulkanBuffer() { Destroy(); }

  // Makes the buffer anew; what it held before is freed, and after an error it is empty. `api` must
  // outlive the buffer. Errors: kDeviceError.
  Status Create(const VulkanApi& api, VkDeviceSize size, VkBufferUsageFlags usage,
                const MemoryWish& wish);

  VkBuffer handle() const { return held_.buffer; }

  VkDeviceSize size() const { return size_; }

  // Null where the memory is not host-visible.
  std::byte* mapped() const { return static_cast<std::byte*>(held_.mapped); }

 private:
  Status CreateByHost(const VkBufferCreateInfo& info, const MemoryWish& wish);
  Status Allocate(const MemoryWish& wish);
  void Destroy();

  const VulkanApi* api_ = nullptr;
  VulkanHostBuffer held_;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;  // none where it is the host's
  VkDeviceSize size_ = 0;
};

}  // namespace limber
