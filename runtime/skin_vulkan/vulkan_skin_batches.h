// Which instances go into one dispatch, and where everything of a frame lies. Calls no Vulkan.
#pragma once

#include "core/vector.h"
#include "skin/skin_transforms.h"
#include "skin_vulkan/vulkan_buffer.h"
#include "skin_vulkan/vulkan_skin_rig.h"

#include <array>
#include <cstdint>
#include <span>

namespace limber {

// Where one kind of a character's numbers goes: the first vertex's first float, and bytes from
// vertex to vertex; both multiples of 4. The host's own buffer (storage usage) and layout.
struct VertexStream {
  VkBuffer buffer = VK_NULL_HANDLE;  // none: not wanted
  VkDeviceSize offset = 0;
  uint32_t stride = 0;
};

// One character in one frame.
struct VulkanSkinJob {
  const VulkanSkinRig* rig = nullptr;
  SkinTransforms transforms;
  uint64_t instance = 0;           // the same number every frame, and no other's
  VertexStream positions;          // 3 floats, mesh space
  VertexStream normals, tangents;  // 3 floats, unit; 4 floats as in glTF
  VertexStream last_positions;     // 3 floats: the positions of the frame before, if the instance
                                   // was in it; else this one's
  bool jumps = false;              // as if it had not been in the frame before
};

// Instances of one rig whose streams lie in the same buffers.
struct SkinBatch {
  const VulkanSkinRig* rig = nullptr;
  uint32_t first = 0, count = 0;             // in SkinBatches::order
  BufferRange matrices, records, positions;  // in the frame's upload buffer and scratch
  std::array<VkBuffer, 4> stream_buffers{};  // in the order of shaders/shared/skin_layout.h
  std::array<BufferRange, 4> stream_ranges{};
};

class SkinBatches {
 public:
  // many: several instances in a dispatch. `api` for its limits; must outlive the object.
  SkinBatches(const VulkanApi& api, bool many) : api_(api), many_(many) {}

  // Instances that follow each other in a vertex buffer and are of one rig come into one batch; the
  // ranges that two batches write do not overlap as long as those of two instances do not.
  // Allocates nothing once it has seen as many jobs. Errors: kInvalidArgument, kLimitExceeded; the
  // message has the job's number.
  Status Plan(std::span<const VulkanSkinJob> jobs);

  std::span<const SkinBatch> batches() const { return batches_; }

  // Job numbers, batch after batch.
  std::span<const uint32_t> order() const { return order_; }

  VkDeviceSize upload_bytes() const { return upload_bytes_; }

  VkDeviceSize scratch_bytes() const { return scratch_bytes_; }

 private:
  Status Check(std::span<const VulkanSkinJob> jobs) const;
  Status CheckStream(const VulkanSkinJob& job, size_t number, uint32_t stream) const;
  bool Extend(const VulkanSkinJob& job, SkinBatch* batch) const;
  SkinBatch Begin(const VulkanSkinJob& job, uint32_t first) const;
  void LayOut();

  const VulkanApi& api_;
  bool many_;
  Vector<SkinBatch> batches_;
  Vector<uint32_t> order_;
  VkDeviceSize upload_bytes_ = 0, scratch_bytes_ = 0;
};

// The streams by their number.
const VertexStream& StreamOf(const VulkanSkinJob& job, uint32_t stream);

}  // namespace limber
