#include "viewer/play_screen.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace limber::viewer {
namespace {

// GLFW's own words, without its habit of several lines.
std::string LastReason() {
  const char* description = nullptr;
  glfwGetError(&description);
  std::string reason = description != nullptr ? description : "no reason given";
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return reason;
}

std::optional<PointerButton> ButtonOf(int glfw_button) {
  switch (glfw_button) {
    case GLFW_MOUSE_BUTTON_LEFT:
      return PointerButton::kLeft;
    case GLFW_MOUSE_BUTTON_MIDDLE:
      return PointerButton::kMiddle;
    case GLFW_MOUSE_BUTTON_RIGHT:
      return PointerButton::kRight;
    default:
      return std::nullopt;
  }
}

std::optional<PlayKey> KeyOf(int glfw_key) {
  switch (glfw_key) {
    case GLFW_KEY_R:
      return PlayKey::kReset;
    case GLFW_KEY_F:
      return PlayKey::kFrame;
    case GLFW_KEY_H:
      return PlayKey::kToggleDots;
    case GLFW_KEY_P:
      return PlayKey::kTogglePin;
    default:
      return std::nullopt;
  }
}

}  // namespace

struct PlayScreen::Callbacks {
  static PlayScreen* Of(GLFWwindow* window) {
    return static_cast<PlayScreen*>(glfwGetWindowUserPointer(window));
  }

  static void Note(PlayScreen* screen, Status status) {
    if (screen->failure_.ok()) screen->failure_ = std::move(status);
  }

  static void Cursor(GLFWwindow* window, double x, double y) {
    // Window coordinates and pixels differ on some screens.
    int width = 0, height = 0;
    glfwGetWindowSize(window, &width, &height);
    const VkExtent2D pixels = Of(window)->picture_size();
    if (width <= 0 || height <= 0) return;
    Of(window)->controls_->PointerMoved(static_cast<float>(x * pixels.width / width),
                                        static_cast<float>(y * pixels.height / height));
  }

  static void Enter(GLFWwindow* window, int entered) {
    if (entered == GLFW_FALSE) Of(window)->controls_->PointerLeft();
  }

  static void Button(GLFWwindow* window, int button, int action, int mods) {
    const std::optional<PointerButton> known = ButtonOf(button);
    if (!known) return;
    PlayScreen* screen = Of(window);
    if (action != GLFW_PRESS) return screen->controls_->ButtonReleased(*known);
    // At the last position that an event told: the pointer itself may be further on by now.
    Note(screen, screen->controls_->ButtonPressed(*known, (mods & GLFW_MOD_ALT) != 0,
                                                  (mods & GLFW_MOD_SHIFT) != 0));
  }

  static void Scroll(GLFWwindow* window, double, double dy) {
    Of(window)->controls_->Scrolled(static_cast<float>(dy));
  }

  static void Key(GLFWwindow* window, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    if (key == GLFW_KEY_ESCAPE) return glfwSetWindowShouldClose(window, GLFW_TRUE);
    const std::optional<PlayKey> known = KeyOf(key);
    if (known) Note(Of(window), Of(window)->controls_->KeyPressed(*known));
  }

  static void Refresh(GLFWwindow* window) { Of(window)->refresh_ = true; }
};

Result<std::unique_ptr<PlayScreen>> PlayScreen::Open(const std::string& title, uint32_t width,
                                                     uint32_t height) {
  if (glfwInit() != GLFW_TRUE) {
    return Error(
        StatusCode::kDeviceError,
        "play: no screen to open a window on (%s); set DISPLAY, or use `limber render` for "
        "pictures without a window",
        LastReason().c_str());
  }
  std::unique_ptr<PlayScreen> screen(new PlayScreen());
  if (glfwVulkanSupported() != GLFW_TRUE) {
    return Error(StatusCode::kDeviceError,
                 "play: no Vulkan for this screen (%s); install a driver (Mesa's lavapipe is in "
                 "mesa-vulkan-drivers)",
                 LastReason().c_str());
  }
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  screen->window_ = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height),
                                     title.c_str(), nullptr, nullptr);
  if (screen->window_ == nullptr) {
    return Error(StatusCode::kDeviceError, "play: the window could not be opened (%s)",
                 LastReason().c_str());
  }
  glfwSetWindowUserPointer(screen->window_, screen.get());
  return screen;
}

PlayScreen::~PlayScreen() {
  if (window_ != nullptr) glfwDestroyWindow(window_);
  glfwTerminate();
}

void PlayScreen::PrepareDevice(DeviceOptions* options) const {
  uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  options->instance_extensions.assign(names, names + count);
  options->create_surface = [window = window_](VkInstance instance, VkSurfaceKHR* surface) {
    return glfwCreateWindowSurface(instance, window, nullptr, surface);
  };
}

void PlayScreen::SendTo(PlayControls* controls) {
  controls_ = controls;
  glfwSetCursorPosCallback(window_, Callbacks::Cursor);
  glfwSetCursorEnterCallback(window_, Callbacks::Enter);
  glfwSetMouseButtonCallback(window_, Callbacks::Button);
  glfwSetScrollCallback(window_, Callbacks::Scroll);
  glfwSetKeyCallback(window_, Callbacks::Key);
  glfwSetWindowRefreshCallback(window_, Callbacks::Refresh);
}

Status PlayScreen::Poll(double seconds) {
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
  return std::exchange(failure_, Status());
}

GamepadSticks PlayScreen::sticks() const {
  GLFWgamepadstate state;
  for (int pad = GLFW_JOYSTICK_1; pad <= GLFW_JOYSTICK_LAST; ++pad) {
    if (glfwGetGamepadState(pad, &state) != GLFW_TRUE) continue;
    return {state.axes[GLFW_GAMEPAD_AXIS_LEFT_X], state.axes[GLFW_GAMEPAD_AXIS_LEFT_Y],
            state.axes[GLFW_GAMEPAD_AXIS_RIGHT_X], state.axes[GLFW_GAMEPAD_AXIS_RIGHT_Y]};
  }
  return {};
}

VkExtent2D PlayScreen::picture_size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return {static_cast<uint32_t>(std::max(width, 0)), static_cast<uint32_t>(std::max(height, 0))};
}

bool PlayScreen::should_close() const {
  return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

bool PlayScreen::TakeRefresh() {
  return std::exchange(refresh_, false);
}

void PlayScreen::SetTitle(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

}  // namespace limber::viewer
