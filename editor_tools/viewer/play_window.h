// `limber play`: a window in which a baked character is dragged about by its handles.
#pragma once

#include "core/status.h"
#include "rig/rig.h"
#include "viewer/materials.h"

#include <cstdint>
#include <memory>
#include <string>

namespace limber::viewer {

struct PlayOptions {
  std::string path;  // a baked .glb or .gltf
  uint32_t width = 1280, height = 800;
  // Close after this many frames, 0: when the user closes the window. For tests and benchmarks; no
  // frame is left out then, even if nothing moves.
  int max_frames = 0;
  std::string screenshot_path;   // the last picture, written as PNG before the window closes
  bool validation = false;       // Khronos layer; anything that it says is an error in the end
  bool wait_for_display = true;  // no more frames than the display shows
  // Alternations of the solver a step. Steps follow each other within a frame until the pose stands
  // still or four milliseconds have gone; with max_frames it is one step a frame.
  int iterations = 1;
  float lambda = 0.5f;  // weight of nearness
};

// What the mouse, the keys and the gamepad do, a line each: for --help.
extern const char kPlayHelp[];

// Loads the file and plays it until the window is closed. Main thread only. Errors: those of
// LoadRig and ReadMaterials; kDeviceError (no screen, no Vulkan, a lost device); kIoError (the
// screenshot); kInternal (the validation layer spoke, with its first words).
Status RunPlay(const PlayOptions& options);

// The same for a rig in memory; options.path is not read.
Status PlayRig(const std::shared_ptr<const Rig>& rig, MaterialSet materials,
               const PlayOptions& options);

}  // namespace limber::viewer
