#include "cli/picture_options.h"

#include "cli/picture_size.h"

#include <numbers>

namespace limber::cli {

void PictureOptions::AddTo(CLI::App* app) {
  app->add_option("--size", size, "Size of a picture (default " + size + ")")->option_text("WxH");
  app->add_option("--yaw", yaw_deg, "Turn the camera around the character, in degrees")
      ->option_text("DEG");
  app->add_option("--pitch", pitch_deg, "Raise the camera, in degrees")->option_text("DEG");
  app->add_option("--zoom", zoom, "Enlarge the character by this factor")
      ->check(CLI::Range(0.01f, 100.0f))
      ->option_text("X");
  app->add_flag("--validate", headless.validation,
                "Run with the Vulkan validation layers; any message is a failure");
}

std::string PictureOptions::Complete() {
  return ParseSize(size, &headless.width, &headless.height);
}

void PictureOptions::Move(viewer::OrbitCamera* camera) const {
  constexpr float kRadians = std::numbers::pi_v<float> / 180;
  camera->Orbit(yaw_deg * kRadians, pitch_deg * kRadians);
  camera->Zoom(1 / zoom);
}

}  // namespace limber::cli
