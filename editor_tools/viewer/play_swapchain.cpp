#include "viewer/play_swapchain.h"

#include "core/vector.h"
#include "skin_vulkan/vulkan_info.h"
#include "viewer/vulkan_list.h"

#include <algorithm>
#include <utility>

namespace limber::viewer {
namespace {

Status Failed(const char* what, VkResult result) {
  return Error(StatusCode::kDeviceError, "play: window: %s failed (VkResult %d)", what,
               static_cast<int>(result));
}

// Sizes that the system leaves to us are marked by this value.
constexpr uint32_t kOurChoice = 0xffffffffu;

VkExtent2D FitExtent(const VkSurfaceCapabilitiesKHR& surface, VkExtent2D wanted) {
  if (surface.currentExtent.width != kOurChoice) return surface.currentExtent;
  return {std::clamp(wanted.width, surface.minImageExtent.width, surface.maxImageExtent.width),
          std::clamp(wanted.height, surface.minImageExtent.height, surface.maxImageExtent.height)};
}

}  // namespace

Result<Swapchain> Swapchain::Create(const SwapchainDevice& device, VkSurfaceKHR surface,
                                    VkExtent2D size, bool wait_for_display) {
  Swapchain swapchain;
  swapchain.device_ = device;
  swapchain.surface_ = surface;
  LIMBER_RETURN_IF_ERROR(swapchain.ChooseFormat());
  LIMBER_RETURN_IF_ERROR(swapchain.ChoosePresentMode(wait_for_display));
  LIMBER_RETURN_IF_ERROR(swapchain.CreateImages(size));
  return swapchain;
}

Swapchain::Swapchain(Swapchain&& other) noexcept
    : device_(other.device_),
      surface_(other.surface_),
      swapchain_(std::exchange(other.swapchain_, VK_NULL_HANDLE)),
      format_(other.format_),
      present_mode_(other.present_mode_),
      extent_(other.extent_),
      images_(std::exchange(other.images_, {})),
      drawn_(std::exchange(other.drawn_, {})),
      ready_(std::exchange(other.ready_, {})),
      next_ready_(other.next_ready_) {}

Swapchain::~Swapchain() {
  if (swapchain_ == VK_NULL_HANDLE && ready_.empty()) return;
  vkDeviceWaitIdle(device_.device);
  DestroySemaphores();
  vkDestroySwapchainKHR(device_.device, swapchain_, nullptr);
}

Status Swapchain::ChooseFormat() {
  Vector<VkSurfaceFormatKHR> formats;
  const auto ask = [this](uint32_t* count, VkSurfaceFormatKHR* out) {
    return vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical_device, surface_, count, out);
  };
  const VkResult result = ListAll(ask, &formats);
  if (result < 0) return Failed("asking for the formats", result);
  const auto wanted = [](const VkSurfaceFormatKHR& f) {
    return f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM;
  };
  const auto found = std::find_if(formats.begin(), formats.end(), wanted);
  if (found == formats.end()) {
    return Error(StatusCode::kDeviceError, "play: window: no 8-bit RGBA format is offered");
  }
  format_ = *found;
  return {};
}

Status Swapchain::ChoosePresentMode(bool wait_for_display) {
  present_mode_ = VK_PRESENT_MODE_FIFO_KHR;  // always there
  if (wait_for_display) return {};
  Vector<VkPresentModeKHR> modes;
  const auto ask = [this](uint32_t* count, VkPresentModeKHR* out) {
    return vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical_device, surface_, count, out);
  };
  const VkResult result = ListAll(ask, &modes);
  if (result < 0) return Failed("asking for the present modes", result);
  for (const VkPresentModeKHR mode : {VK_PRESENT_MODE_IMMEDIATE_KHR, VK_PRESENT_MODE_MAILBOX_KHR}) {
    if (std::find(modes.begin(), modes.end(), mode) != modes.end()) present_mode_ = mode;
  }
  return {};
}

Status Swapchain::CreateImages(VkExtent2D size) {
  VkSurfaceCapabilitiesKHR surface = {};
  VkResult result =
      vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical_device, surface_, &surface);
  if (result != VK_SUCCESS) return Failed("asking for the surface", result);
  if ((surface.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0) {
    return Error(StatusCode::kDeviceError, "play: window: its images cannot be copied to");
  }
  extent_ = FitExtent(surface, size);
  if (extent_.width == 0 || extent_.height == 0) {
    extent_ = {};
    return {};
  }

  LIMBER_RETURN_IF_ERROR(ReplaceSwapchain(surface));
  const auto ask = [this](uint32_t* count, VkImage* out) {
    return vkGetSwapchainImagesKHR(device_.device, swapchain_, count, out);
  };
  result = ListAll(ask, &images_);
  if (result != VK_SUCCESS) return Failed("vkGetSwapchainImagesKHR", result);
  return CreateSemaphores();
}

Status Swapchain::ReplaceSwapchain(const VkSurfaceCapabilitiesKHR& surface) {
  auto info = VulkanInfo<VkSwapchainCreateInfoKHR>(VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR);
  info.surface = surface_;
  info.minImageCount = surface.minImageCount + 1;
  if (surface.maxImageCount > 0) {
    info.minImageCount = std::min(info.minImageCount, surface.maxImageCount);
  }
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent_;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.preTransform = surface.currentTransform;
  info.compositeAlpha = (surface.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = present_mode_;
  info.clipped = VK_TRUE;
  info.oldSwapchain = swapchain_;
  VkSwapchainKHR made = VK_NULL_HANDLE;
  const VkResult result = vkCreateSwapchainKHR(device_.device, &info, nullptr, &made);
  vkDestroySwapchainKHR(device_.device, swapchain_, nullptr);
  swapchain_ = made;
  if (result != VK_SUCCESS) return Failed("vkCreateSwapchainKHR", result);
  return {};
}

Status Swapchain::CreateSemaphores() {
  const auto info = VulkanInfo<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
  drawn_.assign(images_.size(), VK_NULL_HANDLE);
  ready_.assign(images_.size() + 1, VK_NULL_HANDLE);
  next_ready_ = 0;
  for (Vector<VkSemaphore>* set : {&drawn_, &ready_}) {
    for (VkSemaphore& each : *set) {
      const VkResult result = vkCreateSemaphore(device_.device, &info, nullptr, &each);
      if (result != VK_SUCCESS) return Failed("vkCreateSemaphore", result);
    }
  }
  return {};
}

void Swapchain::DestroySemaphores() {
  for (Vector<VkSemaphore>* set : {&drawn_, &ready_}) {
    for (const VkSemaphore each : *set)
      vkDestroySemaphore(device_.device, each, nullptr);
    set->clear();
  }
}

Status Swapchain::Resize(VkExtent2D size) {
  const VkResult result = vkDeviceWaitIdle(device_.device);
  if (result != VK_SUCCESS) return Failed("waiting for the device", result);
  DestroySemaphores();
  images_.clear();
  return CreateImages(size);
}

Result<std::optional<WindowImage>> Swapchain::Acquire() {
  std::optional<WindowImage> none;
  if (extent_.width == 0 || images_.empty()) return none;
  WindowImage next;
  next.ready = ready_[next_ready_];
  const VkResult result = vkAcquireNextImageKHR(device_.device, swapchain_, UINT64_MAX, next.ready,
                                                VK_NULL_HANDLE, &next.index);
  if (result == VK_ERROR_OUT_OF_DATE_KHR) return none;
  if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) {
    return Failed("vkAcquireNextImageKHR", result);
  }
  next_ready_ = (next_ready_ + 1) % ready_.size();
  next.image = images_[next.index];
  next.drawn = drawn_[next.index];
  next.extent = extent_;
  return std::optional<WindowImage>(next);
}

Result<bool> Swapchain::Present(const WindowImage& image) {
  auto info = VulkanInfo<VkPresentInfoKHR>(VK_STRUCTURE_TYPE_PRESENT_INFO_KHR);
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &image.drawn;
  info.swapchainCount = 1;
  info.pSwapchains = &swapchain_;
  info.pImageIndices = &image.index;
  const VkResult result = vkQueuePresentKHR(device_.queue, &info);
  if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) return false;
  if (result != VK_SUCCESS) return Failed("vkQueuePresentKHR", result);
  return true;
}

}  // namespace limber::viewer
