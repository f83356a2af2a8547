// What a host that has a Vulkan device hands over. Limber makes no device, owns no queue, submits
// nothing and waits for nothing.
#pragma once

#include <vulkan/vulkan_core.h>

namespace limber {

// All handles stay the host's and must outlive every object made with them. Needed of the device:
// Vulkan 1.1 and a queue family with compute; no feature, no extension.
struct VulkanHost {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  const VkAllocationCallbacks* callbacks = nullptr;  // optional
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;   // optional
};

}  // namespace limber
