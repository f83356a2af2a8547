// The Vulkan functions that skinning calls, loaded through the host's loader.
#pragma once

#include "core/status.h"
#include "skin_vulkan/vulkan_host.h"
#include "skin_vulkan/vulkan_info.h"

#include <vulkan/vulkan_core.h>

#include <type_traits>

namespace limber {

// One list for the members and for their loading: instance functions, then device functions.
#define LIMBER_VK_INSTANCE_FUNCTIONS(X) \
  X(GetPhysicalDeviceProperties)        \
  X(GetPhysicalDeviceMemoryProperties)  \
  X(GetDeviceProcAddr)

#define LIMBER_VK_DEVICE_FUNCTIONS(X) \
  X(AllocateDescriptorSets)           \
  X(AllocateMemory)                   \
  X(BindBufferMemory)                 \
  X(CmdBindDescriptorSets)            \
  X(CmdBindPipeline)                  \
  X(CmdCopyBuffer)                    \
  X(CmdDispatch)                      \
  X(CmdPipelineBarrier)               \
  X(CmdPushConstants)                 \
  X(CreateBuffer)                     \
  X(CreateComputePipelines)           \
  X(CreateDescriptorPool)             \
  X(CreateDescriptorSetLayout)        \
  X(CreatePipelineLayout)             \
  X(CreateShaderModule)               \
  X(DestroyBuffer)                    \
  X(DestroyDescriptorPool)            \
  X(DestroyDescriptorSetLayout)       \
  X(DestroyPipeline)                  \
  X(DestroyPipelineLayout)            \
  X(DestroyShaderModule)              \
  X(FreeMemory)                       \
  X(GetBufferMemoryRequirements)      \
  X(MapMemory)                        \
  X(UpdateDescriptorSets)

struct VulkanApi {
#define LIMBER_VK_DECLARE(name) PFN_vk##name name = nullptr;
  LIMBER_VK_INSTANCE_FUNCTIONS(LIMBER_VK_DECLARE)
  LIMBER_VK_DEVICE_FUNCTIONS(LIMBER_VK_DECLARE)
#undef LIMBER_VK_DECLARE

  VkDevice device = VK_NULL_HANDLE;
  const VkAllocationCallbacks* callbacks = nullptr;
  VulkanHostMemory host_memory;
  PFN_vkSetDebugUtilsObjectNameEXT set_object_name = nullptr;  // null: nobody reads names
  VkPhysicalDeviceType device_type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  VkPhysicalDeviceLimits limits{};
  VkPhysicalDeviceMemoryProperties memory{};
};

// Errors: kInvalidArgument (a null handle), kDeviceError (a function is missing).
Status LoadVulkanApi(const VulkanHost& host, VulkanApi* api);

// A handle as the debugging tools want it; handles are numbers on some machines, pointers on
// others.
template <class Handle>
uint64_t VulkanObject(Handle handle) {
  if constexpr (std::is_pointer_v<Handle>) {
    return reinterpret_cast<uintptr_t>(handle);
  } else {
    return handle;
  }
}

// Names an object for the host's debugging tools (the instance has VK_EXT_debug_utils).
void NameVulkanObject(const VulkanApi& api, VkObjectType type, uint64_t object, const char* name);

// kDeviceError or kDeviceLost "<what> failed: <name of the result>", or success for VK_SUCCESS.
Status VulkanStatus(VkResult result, const char* what);

}  // namespace limber
