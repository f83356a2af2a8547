#include "engine_device.h"

namespace engine {
namespace {

VKAPI_ATTR VkBool32 VKAPI_CALL OnComplaint(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                           VkDebugUtilsMessageTypeFlagsEXT,
                                           const VkDebugUtilsMessengerCallbackDataEXT* data,
                                           void* user) {
  static_cast<std::vector<std::string>*>(user)->emplace_back(data->pMessage);
  return VK_FALSE;
}

}  // namespace

std::unique_ptr<Device> Device::Create(std::string* reason) {
  std::unique_ptr<Device> made(new Device());
  if (volkInitialize() != VK_SUCCESS) {
    *reason = "there is no Vulkan loader";
    return nullptr;
  }
  if (!made->CreateInstance(reason) || !made->CreateDevice(reason)) return nullptr;
  return made;
}

bool Device::CreateInstance(std::string* reason) {
  auto application = Tagged<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "an engine";
  application.apiVersion = VK_API_VERSION_1_1;
  const char* layers[] = {"VK_LAYER_KHRONOS_validation"};
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
  const VkValidationFeatureEnableEXT synchronization[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  auto features = Tagged<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = synchronization;
  auto info = Tagged<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pNext = &features;
  info.pApplicationInfo = &application;
  info.enabledLayerCount = info.enabledExtensionCount = 1;
  info.ppEnabledLayerNames = layers;
  info.ppEnabledExtensionNames = extensions;
  if (vkCreateInstance(&info, nullptr, &instance) != VK_SUCCESS) {
    *reason = "vkCreateInstance failed (vulkan-validationlayers and mesa-vulkan-drivers?)";
    return false;
  }
  volkLoadInstance(instance);
  auto messenger = Tagged<VkDebugUtilsMessengerCreateInfoEXT>(
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                              VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = OnComplaint;
  messenger.pUserData = &complaints;
  return vkCreateDebugUtilsMessengerEXT(instance, &messenger, nullptr, &messenger_) == VK_SUCCESS;
}

bool Device::CreateDevice(std::string* reason) {
  uint32_t count = 1;
  vkEnumeratePhysicalDevices(instance, &count, &physical);
  if (count == 0) {
    *reason = "there is no Vulkan device";
    return false;
  }
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  // Of software devices the first family does everything; an engine would look.
  const float priority = 1;
  auto queues = Tagged<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queues.queueFamilyIndex = queue_family;
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  auto info = Tagged<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queues;
  if (vkCreateDevice(physical, &info, nullptr, &device) != VK_SUCCESS) {
    *reason = "vkCreateDevice failed";
    return false;
  }
  vkGetDeviceQueue(device, queue_family, 0, &queue);
  return true;
}

Device::~Device() {
  if (device != VK_NULL_HANDLE) {
    vkDeviceWaitIdle(device);
    vkDestroyDevice(device, nullptr);
  }
  if (instance == VK_NULL_HANDLE) return;
  vkDestroyDebugUtilsMessengerEXT(instance, messenger_, nullptr);
  vkDestroyInstance(instance, nullptr);
}

}  // namespace engine
