// Frames without a window: a device, a renderer and the way back to main memory.
#pragma once

#include "core/vector.h"
#include "rig/rig.h"
#include "viewer/image.h"
#include "viewer/picture_reader.h"
#include "viewer/renderer.h"

#include <filesystem>
#include <memory>

namespace limber::viewer {

struct HeadlessOptions {
  uint32_t width = 1280, height = 720;
  bool validation = false;  // the Khronos layer with synchronization validation
  float dot_radius = 0;     // pixels; 0: by the height of the picture
};

struct FrameTimes {
  double skin_ms = 0, draw_ms = 0;  // on the device; zero where it has no timestamps
  double readback_ms = 0;           // copying the picture out of mapped memory
  double total_ms = 0;              // wall clock of RenderFrame
};

class HeadlessRenderer {
 public:
  // With the materials of `materials_file` (.glb or .gltf; empty: none). Materials that cannot be
  // read are warnings; a file that cannot be read is an error.
  static Result<std::unique_ptr<HeadlessRenderer>> Create(
      const Rig& rig, const std::filesystem::path& materials_file, const HeadlessOptions& options);
  static Result<std::unique_ptr<HeadlessRenderer>> Create(const CharacterSource& source,
                                                          const HeadlessOptions& options);
  HeadlessRenderer(const HeadlessRenderer&) = delete;
  HeadlessRenderer& operator=(const HeadlessRenderer&) = delete;

  // Draws and waits. `image` is resized as needed. Errors: kInvalidArgument, kDeviceError.
  Status RenderFrame(const SkinTransforms& transforms, const OrbitCamera& camera,
                     std::span<const HandleDot> dots, Image* image);

  OrbitCamera DefaultCamera() const { return renderer_->DefaultCamera(); }

  const Renderer& renderer() const { return *renderer_; }

  const FrameTimes& times() const { return times_; }  // of the last frame

  const char* device_name() const { return device_->properties().deviceName; }

  const ValidationLog& validation_log() const { return device_->validation_log(); }

  const Vector<std::string>& warnings() const { return warnings_; }

 private:
  HeadlessRenderer() = default;

  std::unique_ptr<VulkanDevice> device_;  // first, so that it goes last
  std::unique_ptr<Renderer> renderer_;
  PictureReader reader_;
  FrameTimes times_;
  Vector<std::string> warnings_;
};

}  // namespace limber::viewer
