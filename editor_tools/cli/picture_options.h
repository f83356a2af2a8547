// Options of the commands that draw pictures without a window: their size and the camera.
#pragma once

#include "viewer/camera.h"
#include "viewer/headless.h"

#include <CLI/CLI.hpp>

#include <string>

namespace limber::cli {

struct PictureOptions {
  std::string size;  // WxH; what it begins with is the default
  float yaw_deg = 0, pitch_deg = 0, zoom = 1;
  viewer::HeadlessOptions headless = {};

  void AddTo(CLI::App* app);

  // Reads the size into `headless`; an empty string, or a message for a wrong command line.
  std::string Complete();

  // Where a camera that looks at the whole character is moved to.
  void Move(viewer::OrbitCamera* camera) const;
};

}  // namespace limber::cli
