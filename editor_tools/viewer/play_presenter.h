// From a scene to the window: the renderer's picture, copied to the swapchain's images.
#pragma once

#include "core/status.h"
#include "viewer/play_swapchain.h"
#include "viewer/renderer.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace limber::viewer {

// One frame is in flight: the next solve runs on the CPU while it is drawn.
class PlayPresenter {
 public:
  // `device` (with a surface) must outlive the presenter. `size` is the window's, in pixels.
  static Result<std::unique_ptr<PlayPresenter>> Create(VulkanDevice* device,
                                                       const CharacterSource& source,
                                                       VkExtent2D size, bool wait_for_display);
  PlayPresenter(const PlayPresenter&) = delete;
  PlayPresenter& operator=(const PlayPresenter&) = delete;
  ~PlayPresenter();  // waits for the device

  // Makes the picture the size of the window where it is not, or where the window has gone out of
  // date. True when there is a new size. Errors: kDeviceError.
  Result<bool> Fit(VkExtent2D window_size);

  // The picture's size; what Fit last found, never zero.
  VkExtent2D extent() const { return renderer_->extent(); }

  // Draws and shows a frame; false when the window could not take one (minimised, being resized):
  // call again after Fit. Errors: kDeviceError, kInvalidArgument.
  Result<bool> Show(const Scene& scene);

  // What the last frame but one cost on the device; zero before, and where there is no clock.
  StageTimes times() const { return times_; }

  // The last picture as PNG, without the window's frame. Errors: kIoError, kDeviceError.
  Status Screenshot(const std::filesystem::path& path);

 private:
  explicit PlayPresenter(VulkanDevice* device) : device_(device) {}

  Status Initialize(const CharacterSource& source, VkExtent2D size, bool wait_for_display);
  Status WaitForFrame();
  Status Record(const Scene& scene, const WindowImage& window);
  void RecordCopy(const WindowImage& window) const;
  Status Submit(const WindowImage& window);

  VulkanDevice* device_;
  std::optional<Swapchain> swapchain_;
  std::unique_ptr<Renderer> renderer_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  StageTimes times_;
  bool in_flight_ = false;
  bool stale_ = false;  // the swapchain's images no longer fit the window
};

}  // namespace limber::viewer
