// The engine's renderer: two frames in flight, each with a picture of its own that is read back.
#pragma once

#include "engine_device.h"
#include "engine_memory.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace engine {

// As the shaders read it (character.vert).
struct Vertex {
  float position[3], normal[3], last[3];
};

struct DrawCall {
  VkBuffer vertices = VK_NULL_HANDLE, indices = VK_NULL_HANDLE;
  int32_t first_vertex = 0;
  uint32_t num_indices = 0;
  glm::vec4 place = {0, 0, 0, 1};  // xyz, size
  glm::vec3 colour = {1, 1, 1};    // linear
  float turn = 0;                  // about y
  bool is_flat = false;            // its triangles cover each other in their order, not by depth
};

class Renderer {
 public:
  static constexpr uint32_t kSlots = 2, kWidth = 960, kHeight = 540;

  Renderer(Device* device, BufferHeap* heap);
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  ~Renderer();

  // Waits for the slot, then records: `before_pass` with the command buffer, the draws, the copy of
  // the picture; submits.
  void Frame(uint32_t slot, const glm::mat4& clip_from_world, float frames_a_second,
             const std::function<void(VkCommandBuffer)>& before_pass,
             const std::vector<DrawCall>& draws);
  void WaitAll();

  // RGBA rows from the top of the slot's last frame; waits for it.
  const uint8_t* Picture(uint32_t slot);

 private:
  struct Image {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
  };

  struct Slot {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence done = VK_NULL_HANDLE;
    Image colour, depth;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    BufferHeap::Piece picture;
  };

  void MakeImage(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect, Image* image);
  void FreeImage(const Image& image);
  void MakePass();
  void MakePipeline();
  void MakeSlot(Slot* slot);
  void RecordDraws(VkCommandBuffer commands, const glm::mat4& clip_from_world,
                   float frames_a_second, const std::vector<DrawCall>& draws) const;

  Device* device_;
  BufferHeap* heap_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkRenderPass pass_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipelines_[2] = {};  // by depth; flat, in the order of drawing
  std::array<Slot, kSlots> slots_;
};

}  // namespace engine
