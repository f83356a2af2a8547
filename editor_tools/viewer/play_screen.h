// The window on the screen: GLFW behind a wall, its events handed to the controls.
#pragma once

#include "core/status.h"
#include "viewer/device.h"
#include "viewer/play_controls.h"

#include <memory>
#include <string>

struct GLFWwindow;

namespace limber::viewer {

// One window at a time in a process, on the main thread (GLFW's rule).
class PlayScreen {
 public:
  // Errors: kDeviceError where there is no display, or no Vulkan for it.
  static Result<std::unique_ptr<PlayScreen>> Open(const std::string& title, uint32_t width,
                                                  uint32_t height);
  PlayScreen(const PlayScreen&) = delete;
  PlayScreen& operator=(const PlayScreen&) = delete;
  ~PlayScreen();

  // What the device must be made with to draw into this window.
  void PrepareDevice(DeviceOptions* options) const;
  // Events go there from now on; the controls must outlive the polling.
  void SendTo(PlayControls* controls);

  // Hands over what has happened. Waits up to `seconds` for something to happen, 0 for not at all.
  // Errors: what a control reported.
  Status Poll(double seconds);
  // The first gamepad's sticks; nothing pushed where there is none.
  GamepadSticks sticks() const;

  VkExtent2D picture_size() const;  // pixels; 0 x 0 while minimised
  bool should_close() const;
  // The picture in the window is stale (uncovered, resized) since the last call.
  bool TakeRefresh();
  void SetTitle(const std::string& title);

 private:
  PlayScreen() = default;
  struct Callbacks;

  GLFWwindow* window_ = nullptr;
  PlayControls* controls_ = nullptr;
  Status failure_;
  bool refresh_ = true;
};

}  // namespace limber::viewer
