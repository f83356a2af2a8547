#include "viewer/device.h"

#include "core/vector.h"
#include "viewer/vulkan_list.h"

#include <algorithm>
#include <cstring>

namespace limber::viewer {
namespace {

constexpr char kValidationLayer[] = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL OnMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                         VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data,
                                         void* user) {
  static_cast<ValidationLog*>(user)->Add(data->pMessage != nullptr ? data->pMessage : "");
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT MessengerInfo(ValidationLog* log) {
  auto info = VulkanInfo<VkDebugUtilsMessengerCreateInfoEXT>(
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                         VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  info.pfnUserCallback = OnMessage;
  info.pUserData = log;
  return info;
}

bool HasValidationLayer() {
  Vector<VkLayerProperties> layers;
  ListAll(vkEnumerateInstanceLayerProperties, &layers);
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
    return std::strcmp(layer.layerName, kValidationLayer) == 0;
  });
}

bool HasDeviceExtension(VkPhysicalDevice device, const char* name) {
  Vector<VkExtensionProperties> extensions;
  const auto ask = [device](uint32_t* count, VkExtensionProperties* out) {
    return vkEnumerateDeviceExtensionProperties(device, nullptr, count, out);
  };
  ListAll(ask, &extensions);
  return std::any_of(extensions.begin(), extensions.end(), [name](const auto& extension) {
    return std::strcmp(extension.extensionName, name) == 0;
  });
}

Vector<VkQueueFamilyProperties> QueueFamilies(VkPhysicalDevice device) {
  Vector<VkQueueFamilyProperties> families;
  const auto ask = [device](uint32_t* count, VkQueueFamilyProperties* out) {
    vkGetPhysicalDeviceQueueFamilyProperties(device, count, out);
  };
  ListAll(ask, &families);
  return families;
}

int Preference(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    default:
      return 1;
  }
}

}  // namespace

Result<std::unique_ptr<VulkanDevice>> VulkanDevice::Create(const DeviceOptions& options) {
  if (volkInitialize() != VK_SUCCESS) {
    return Error(StatusCode::kDeviceError,
                 "vulkan: no loader found; install libvulkan1 and a driver (Mesa's lavapipe is in "
                 "mesa-vulkan-drivers)");
  }
  std::unique_ptr<VulkanDevice> device(new VulkanDevice());
  LIMBER_RETURN_IF_ERROR(device->CreateInstance(options));
  if (options.create_surface) {
    LIMBER_RETURN_IF_ERROR(VulkanStatus(
        options.create_surface(device->instance_, &device->surface_), "creating the surface"));
  }
  LIMBER_RETURN_IF_ERROR(device->ChoosePhysicalDevice());
  LIMBER_RETURN_IF_ERROR(device->CreateDevice(device->surface_ != VK_NULL_HANDLE));
  LIMBER_RETURN_IF_ERROR(LoadVulkanApi(device->host(), &device->api_));
  return device;
}

VulkanDevice::~VulkanDevice() {
  if (device_ != VK_NULL_HANDLE) {
    vkDeviceWaitIdle(device_);
    vkDestroyCommandPool(device_, command_pool_, nullptr);
    vkDestroyDevice(device_, nullptr);
  }
  if (instance_ == VK_NULL_HANDLE) return;
  if (surface_ != VK_NULL_HANDLE) vkDestroySurfaceKHR(instance_, surface_, nullptr);
  if (messenger_ != VK_NULL_HANDLE) {
    vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
  }
  vkDestroyInstance(instance_, nullptr);
}

Status VulkanDevice::CreateInstance(const DeviceOptions& options) {
  auto application = VulkanInfo<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "limber";
  application.apiVersion = VK_API_VERSION_1_1;
  auto info = VulkanInfo<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  Vector<const char*> extensions = options.instance_extensions;
  const char* layer = kValidationLayer;
  VkDebugUtilsMessengerCreateInfoEXT messenger = MessengerInfo(log_.get());
  const VkValidationFeatureEnableEXT enabled[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  auto features = VulkanInfo<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enabled;
  if (options.validation) {
    if (!HasValidationLayer()) {
      return Error(StatusCode::kDeviceError,
                   "vulkan: %s is not installed; install vulkan-validationlayers",
                   kValidationLayer);
    }
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &layer;
    info.pNext = &features;
    features.pNext = &messenger;
  }
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {
    return Error(StatusCode::kDeviceError,
                 "vulkan: no driver found; install one (Mesa's lavapipe is in "
                 "mesa-vulkan-drivers) or correct VK_ICD_FILENAMES");
  }
  LIMBER_RETURN_IF_ERROR(VulkanStatus(result, "vkCreateInstance"));
  volkLoadInstance(instance_);
  if (!options.validation) return {};
  return VulkanStatus(vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_),
                      "vkCreateDebugUtilsMessengerEXT");
}

bool VulkanDevice::FindQueueFamily(VkPhysicalDevice candidate, uint32_t* family) const {
  const Vector<VkQueueFamilyProperties> families = QueueFamilies(candidate);
  constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (uint32_t i = 0; i < families.size(); ++i) {
    if ((families[i].queueFlags & kNeeded) != kNeeded) continue;
    if (surface_ != VK_NULL_HANDLE) {
      VkBool32 presents = VK_FALSE;
      vkGetPhysicalDeviceSurfaceSupportKHR(candidate, i, surface_, &presents);
      if (presents == VK_FALSE) continue;
    }
    *family = i;
    return true;
  }
  return false;
}

Status VulkanDevice::ChoosePhysicalDevice() {
  Vector<VkPhysicalDevice> candidates;
  const auto ask = [this](uint32_t* count, VkPhysicalDevice* out) {
    return vkEnumeratePhysicalDevices(instance_, count, out);
  };
  ListAll(ask, &candidates);
  int best = 0;
  for (VkPhysicalDevice candidate : candidates) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(candidate, &properties);
    uint32_t family = 0;
    if (properties.apiVersion < VK_API_VERSION_1_1 || !FindQueueFamily(candidate, &family) ||
        (surface_ != VK_NULL_HANDLE &&
         !HasDeviceExtension(candidate, VK_KHR_SWAPCHAIN_EXTENSION_NAME)) ||
        Preference(properties.deviceType) <= best) {
      continue;
    }
    best = Preference(properties.deviceType);
    physical_device_ = candidate;
    properties_ = properties;
    queue_family_ = family;
  }
  if (best > 0) return {};
  return Error(
      StatusCode::kDeviceError,
      "vulkan: none of %zu devices has Vulkan 1.1 with graphics%s; install a driver (Mesa's "
      "lavapipe is in mesa-vulkan-drivers)",
      candidates.size(), surface_ != VK_NULL_HANDLE ? " and can present to this window" : "");
}

Status VulkanDevice::CreateDevice(bool with_swapchain) {
  VkPhysicalDeviceFeatures available;
  vkGetPhysicalDeviceFeatures(physical_device_, &available);
  // Free on a GPU; on a processor it costs more than the rest of the picture.
  anisotropy_ = available.samplerAnisotropy == VK_TRUE &&
                properties_.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU;
  VkPhysicalDeviceFeatures wanted{};
  wanted.samplerAnisotropy = anisotropy_ ? VK_TRUE : VK_FALSE;

  const float priority = 1;
  auto queue = VulkanInfo<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  const char* extension = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  auto info = VulkanInfo<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = with_swapchain ? 1 : 0;
  info.ppEnabledExtensionNames = &extension;
  info.pEnabledFeatures = &wanted;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(vkCreateDevice(physical_device_, &info, nullptr, &device_), "vkCreateDevice"));
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);

  const bool timestamps = QueueFamilies(physical_device_)[queue_family_].timestampValidBits > 0;
  timestamp_period_ = timestamps ? double{properties_.limits.timestampPeriod} : 0;

  auto pool = VulkanInfo<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = queue_family_;
  return VulkanStatus(vkCreateCommandPool(device_, &pool, nullptr, &command_pool_),
                      "vkCreateCommandPool");
}

VulkanHost VulkanDevice::host() const {
  VulkanHost host;
  host.instance = instance_;
  host.physical_device = physical_device_;
  host.device = device_;
  host.get_instance_proc_addr = vkGetInstanceProcAddr;
  return host;
}

Status VulkanDevice::SubmitAndWait(const std::function<void(VkCommandBuffer)>& record) {
  auto allocate =
      VulkanInfo<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = command_pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(vkAllocateCommandBuffers(device_, &allocate, &commands),
                                      "vkAllocateCommandBuffers"));
  auto begin = VulkanInfo<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  VkResult result = vkBeginCommandBuffer(commands, &begin);
  if (result == VK_SUCCESS) {
    record(commands);
    result = vkEndCommandBuffer(commands);
  }
  auto submit = VulkanInfo<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  if (result == VK_SUCCESS) result = vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE);
  if (result == VK_SUCCESS) result = vkQueueWaitIdle(queue_);
  vkFreeCommandBuffers(device_, command_pool_, 1, &commands);
  return VulkanStatus(result, "a submission");
}

}  // namespace limber::viewer
