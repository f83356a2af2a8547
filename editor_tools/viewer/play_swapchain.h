// The window's images: a swapchain that survives resizing, minimising and a lost surface size.
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <volk.h>

#include <cstdint>
#include <optional>

namespace limber::viewer {

// Borrowed from whoever owns the device; must outlive the swapchain.
struct SwapchainDevice {
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  // draws and presents
};

// One image of the window, from Acquire until Present. Wait for `ready` before the first write (a
// transfer), signal `drawn` after the last; the image comes undefined and must be left in
// VK_IMAGE_LAYOUT_PRESENT_SRC_KHR.
struct WindowImage {
  uint32_t index = 0;
  VkImage image = VK_NULL_HANDLE;
  VkExtent2D extent = {};
  VkSemaphore ready = VK_NULL_HANDLE;
  VkSemaphore drawn = VK_NULL_HANDLE;
};

// Written to by blits (transfer destination), in the display's own encoding (UNORM).
class Swapchain {
 public:
  // The surface is borrowed. `size` counts where the system leaves the size to us (Wayland).
  // `wait_for_display`: FIFO; otherwise MAILBOX or IMMEDIATE where there are any (benchmarks).
  static Result<Swapchain> Create(const SwapchainDevice& device, VkSurfaceKHR surface,
                                  VkExtent2D size, bool wait_for_display);
  Swapchain(Swapchain&& other) noexcept;
  Swapchain& operator=(Swapchain&&) = delete;
  ~Swapchain();  // waits for the device to be idle

  // The next image; nothing while the window has no area (minimised) or when the images no longer
  // fit it (Resize, then try again).
  Result<std::optional<WindowImage>> Acquire();
  // Queues the image for display; false when the images no longer fit the window.
  Result<bool> Present(const WindowImage& image);
  // Makes new images of the window's present size. Waits for the device to be idle.
  Status Resize(VkExtent2D size);

  VkExtent2D extent() const { return extent_; }  // 0 x 0 while minimised

  VkFormat format() const { return format_.format; }

 private:
  Swapchain() = default;
  Status ChooseFormat();
  Status ChoosePresentMode(bool wait_for_display);
  Status CreateImages(VkExtent2D size);
  Status ReplaceSwapchain(const VkSurfaceCapabilitiesKHR& surface);
  Status CreateSemaphores();
  void DestroySemaphores();

  SwapchainDevice device_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_ = {};
  VkPresentModeKHR present_mode_ = VK_PRESENT_MODE_FIFO_KHR;
  VkExtent2D extent_ = {};
  Vector<VkImage> images_;
  Vector<VkSemaphore> drawn_;  // one for each image: presenting may outlast the frame's fence
  Vector<VkSemaphore> ready_;  // used in turn; one more than images
  size_t next_ready_ = 0;
};

}  // namespace limber::viewer
