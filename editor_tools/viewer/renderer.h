// Draws one skinned character under studio light, with its handles as dots.
//
// The picture belongs to the renderer: after the recorded commands have run it lies in picture()
// in layout TRANSFER_SRC_OPTIMAL, sRGB-encoded R8G8B8A8, ready to be copied to memory or blitted to
// a window's image. One thread at a time.
#pragma once

#include "core/vector.h"
#include "skin/skin_transforms.h"
#include "viewer/camera.h"
#include "viewer/character_model.h"
#include "viewer/render_pipelines.h"
#include "viewer/render_targets.h"

#include <memory>
#include <span>

namespace limber::viewer {

// A handle as it is drawn: pinned ones filled, free ones as rings, on top of everything.
struct HandleDot {
  Vec3 position;  // mesh space
  bool pinned = true;
  bool hovered = false;
  bool grabbed = false;
};

struct RendererOptions {
  uint32_t width = 1280, height = 720;
  uint32_t frames_in_flight = 2;
  float dot_radius = 0;  // pixels; 0: by the height of the picture
};

struct Scene {
  SkinTransforms transforms;
  const OrbitCamera* camera = nullptr;
  std::span<const HandleDot> dots;  // at most kMaxDots are drawn
};

// What a frame cost on the device; zero where the queue has no timestamps.
struct StageTimes {
  double skin_ms = 0, draw_ms = 0;
};

class Renderer {
 public:
  static constexpr uint32_t kMaxDots = 1024;

  // `device` must outlive the renderer. Waits for its uploads.
  // Errors: kMalformed, kLimitExceeded, kInvalidArgument, kDeviceError.
  static Result<std::unique_ptr<Renderer>> Create(VulkanDevice* device,
                                                  const CharacterSource& source,
                                                  const RendererOptions& options);
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  // Waits for the device.
  ~Renderer();

  // Another size of picture. Waits for the device. Errors: kInvalidArgument, kDeviceError.
  Status Resize(uint32_t width, uint32_t height);

  // Records skinning and drawing with slot `frame` (below frames_in_flight; its previous use has
  // finished on the device). Outside a render pass. Errors: kInvalidArgument.
  Status Record(VkCommandBuffer commands, uint32_t frame, const Scene& scene);

  VkImage picture() const { return targets_.picture(); }

  VkExtent2D extent() const { return targets_.extent(); }

  // Of the last finished frame of that slot; call after its fence.
  StageTimes times(uint32_t frame) const;

  // The box around all example shapes, mesh space; and a camera that frames the character.
  const Bounds& bounds() const { return bounds_; }

  OrbitCamera DefaultCamera() const;

 private:
  struct Slot {
    VulkanBuffer uniforms, dots;
    VkDescriptorSet set = VK_NULL_HANDLE;
    bool timed = false;
  };

  Renderer(VulkanDevice* device, const RendererOptions& options)
      : device_(device),
        options_(options) {}

  Status Initialize(const CharacterSource& source);
  Status CreateSlots();
  void WriteSet(const Slot& slot) const;
  void WriteUniforms(const Slot& slot, const Scene& scene, uint32_t num_dots) const;
  void RecordShadow(VkCommandBuffer commands, uint32_t frame) const;
  void RecordColor(VkCommandBuffer commands, uint32_t frame, uint32_t num_dots) const;
  void RecordDraws(VkCommandBuffer commands, bool blend) const;
  void Timestamp(VkCommandBuffer commands, uint32_t frame, uint32_t index) const;

  VulkanDevice* device_;
  RendererOptions options_;
  RenderTargets targets_;
  RenderPipelines pipelines_;
  std::unique_ptr<CharacterModel> model_;
  Vector<Slot> slots_;
  VulkanDescriptors sets_;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  Bounds bounds_, view_bounds_;
  RigSpace space_;
  float ground_height_ = 0;
  bool flat_ = false;
};

}  // namespace limber::viewer
