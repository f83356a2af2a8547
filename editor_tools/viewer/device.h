// A Vulkan instance, device and queue for the viewer, with or without a window's surface.
//
// Functions come through volk (global function pointers of the loader, which dispatch by handle):
// several devices may exist, one after the other or side by side.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "skin_vulkan/vulkan_api.h"
#include "viewer/validation_log.h"

#include <volk.h>

#include <functional>
#include <memory>
#include <string>

namespace limber::viewer {

struct DeviceOptions {
  // The Khronos layer with synchronization validation. kDeviceError where it is not installed.
  bool validation = false;
  Vector<const char*> instance_extensions;  // for a window: what GLFW asks for
  // Makes the window's surface, after the instance and before a device is chosen; null: headless.
  // The device then is one that can present to it, and has VK_KHR_swapchain.
  std::function<VkResult(VkInstance, VkSurfaceKHR*)> create_surface;
};

class VulkanDevice {
 public:
  // Chooses the fastest kind of device that has Vulkan 1.1, graphics and compute in one queue
  // family (discrete, integrated, virtual, then a CPU such as Mesa's lavapipe).
  // Errors: kDeviceError with what to install.
  static Result<std::unique_ptr<VulkanDevice>> Create(const DeviceOptions& options);
  VulkanDevice(const VulkanDevice&) = delete;
  VulkanDevice& operator=(const VulkanDevice&) = delete;
  ~VulkanDevice();

  VkInstance instance() const { return instance_; }

  VkPhysicalDevice physical_device() const { return physical_device_; }

  VkDevice handle() const { return device_; }

  VkQueue queue() const { return queue_; }

  uint32_t queue_family() const { return queue_family_; }

  VkSurfaceKHR surface() const { return surface_; }

  VkCommandPool command_pool() const { return command_pool_; }  // resettable buffers

  const VkPhysicalDeviceProperties& properties() const { return properties_; }

  bool anisotropy() const { return anisotropy_; }

  // Nanoseconds of one timestamp tick; 0 where the queue has no timestamps.
  double timestamp_period() const { return timestamp_period_; }

  // What VulkanSkinner and VulkanBuffer take.
  VulkanHost host() const;

  const VulkanApi& api() const { return api_; }

  ValidationLog& validation_log() const { return *log_; }

  // Records, submits and waits: for uploads and other work outside the frame loop.
  Status SubmitAndWait(const std::function<void(VkCommandBuffer)>& record);

 private:
  VulkanDevice() = default;
  Status CreateInstance(const DeviceOptions& options);
  Status ChoosePhysicalDevice();
  Status CreateDevice(bool with_swapchain);
  bool FindQueueFamily(VkPhysicalDevice candidate, uint32_t* family) const;

  std::unique_ptr<ValidationLog> log_ = std::make_unique<ValidationLog>();
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device_ = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties_{};
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  uint32_t queue_family_ = 0;
  VkCommandPool command_pool_ = VK_NULL_HANDLE;
  VulkanApi api_;
  bool anisotropy_ = false;
  double timestamp_period_ = 0;
};

}  // namespace limber::viewer
