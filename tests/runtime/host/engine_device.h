// The engine's own Vulkan device: instance with validation, one queue.
#pragma once

#include <volk.h>

#include <memory>
#include <string>
#include <vector>

namespace engine {

// Vulkan's tagged structures, zeroed but for their tag.
template <class Info>
Info Tagged(VkStructureType type) {
  Info info = {};
  info.sType = type;
  return info;
}

class Device {
 public:
  // Null with a reason where there is no Vulkan.
  static std::unique_ptr<Device> Create(std::string* reason);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device();

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queue_family = 0;
  VkPhysicalDeviceMemoryProperties memory = {};
  std::vector<std::string> complaints;  // of the validation layers

 private:
  Device() = default;
  bool CreateInstance(std::string* reason);
  bool CreateDevice(std::string* reason);

  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace engine
