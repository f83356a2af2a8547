// What a host that has a Vulkan device hands over. Limber makes no device, owns no queue, submits
// nothing and waits for nothing.
#pragma once

#include <vulkan/vulkan_core.h>

namespace limber {

// A buffer and its memory, from the host's allocator.
struct VulkanHostBuffer {
  VkBuffer buffer = VK_NULL_HANDLE;
  void* mapped = nullptr;      // where host-visible memory was required, or was had nevertheless
  void* allocation = nullptr;  // the allocator's own
};

// The host's allocator of buffers. Limber asks for few and large ones, not in steady frames.
struct VulkanHostMemory {
  // Both null: Limber takes its memory from the device itself.
  VkResult (*create)(void* user, const VkBufferCreateInfo& info, VkMemoryPropertyFlags required,
                     VkMemoryPropertyFlags preferred, VulkanHostBuffer* buffer) = nullptr;
  void (*destroy)(void* user, const VulkanHostBuffer& buffer) = nullptr;
  void* user = nullptr;
};

// All handles stay the host's and must outlive every object made with them. Needed of the device:
// Vulkan 1.1, a queue family with compute, and kNumSkinBuffers storage buffers in one stage (all
// but some phones); no feature, no extension.
struct VulkanHost {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  const VkAllocationCallbacks* callbacks = nullptr;  // optional
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;   // optional
  VulkanHostMemory memory;                           // optional
};

// Of limits.maxPerStageDescriptorStorageBuffers.
inline constexpr uint32_t kNumSkinBuffers = 13;

}  // namespace limber
