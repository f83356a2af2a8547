#include "skin_vulkan/vulkan_api.h"

namespace limber {

Status LoadVulkanApi(const VulkanHost& host, VulkanApi* api) {
  if (host.instance == VK_NULL_HANDLE || host.physical_device == VK_NULL_HANDLE ||
      host.device == VK_NULL_HANDLE || host.get_instance_proc_addr == nullptr) {
    return Error(StatusCode::kInvalidArgument,
                 "vulkan host: a handle or the loader function is null; set all four");
  }
#define LIMBER_VK_LOAD(name)                                                                  \
  api->name =                                                                                 \
      reinterpret_cast<PFN_vk##name>(host.get_instance_proc_addr(host.instance, "vk" #name)); \
  if (api->name == nullptr) {                                                                 \
    return Error(StatusCode::kDeviceError, "vulkan host: the loader has no vk%s", #name);     \
  }
  LIMBER_VK_INSTANCE_FUNCTIONS(LIMBER_VK_LOAD)
#undef LIMBER_VK_LOAD
#define LIMBER_VK_LOAD(name)                                                                   \
  api->name = reinterpret_cast<PFN_vk##name>(api->GetDeviceProcAddr(host.device, "vk" #name)); \
  if (api->name == nullptr) {                                                                  \
    return Error(StatusCode::kDeviceError, "vulkan host: the device has no vk%s", #name);      \
  }
  LIMBER_VK_DEVICE_FUNCTIONS(LIMBER_VK_LOAD)
#undef LIMBER_VK_LOAD
  api->device = host.device;
  api->callbacks = host.callbacks;
  api->host_memory = host.memory;
  if ((host.memory.create == nullptr) != (host.memory.destroy == nullptr)) {
    return Error(StatusCode::kInvalidArgument,
                 "vulkan host: of the allocator's two functions one is null; set both or none");
  }
  api->set_object_name = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
      api->GetDeviceProcAddr(host.device, "vkSetDebugUtilsObjectNameEXT"));
  VkPhysicalDeviceProperties properties;
  api->GetPhysicalDeviceProperties(host.physical_device, &properties);
  api->device_type = properties.deviceType;
  api->limits = properties.limits;
  api->GetPhysicalDeviceMemoryProperties(host.physical_device, &api->memory);
  return {};
}

void NameVulkanObject(const VulkanApi& api, VkObjectType type, uint64_t object, const char* name) {
  if (api.set_object_name == nullptr) return;
  auto info =
      VulkanInfo<VkDebugUtilsObjectNameInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT);
  info.objectType = type;
  info.objectHandle = object;
  info.pObjectName = name;
  api.set_object_name(api.device, &info);  // a name less is no failure
}

Status VulkanStatus(VkResult result, const char* what) {
  const char* name = "an unknown error";
  switch (result) {
    case VK_SUCCESS:
      return {};
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      name = "out of host memory";
      break;
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      name = "out of device memory";
      break;
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      name = "out of descriptor pool memory";
      break;
    case VK_ERROR_DEVICE_LOST:
      name = "device lost";
      break;
    case VK_ERROR_MEMORY_MAP_FAILED:
      name = "memory could not be mapped";
      break;
    default:
      break;
  }
  return Error(result == VK_ERROR_DEVICE_LOST ? StatusCode::kDeviceLost : StatusCode::kDeviceError,
               "vulkan: %s failed: %s (VkResult %d)", what, name, static_cast<int>(result));
}

}  // namespace limber
