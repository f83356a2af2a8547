// Eq. 6, normals and tangents as Vulkan compute, recorded into the host's command buffer, written
// into the host's vertex buffers.
//
//   VulkanSkinner   one for each device and queue: pipelines, scratch, one slot a frame in flight
//   VulkanSkinRig   one for each rig: its tables
//
// Nothing here submits or waits. Calls on one object and its rigs come from one thread at a time;
// objects are independent of each other. What Vulkan must have: vulkan_host.h.
#pragma once

#include "core/memory_source.h"
#include "core/status.h"
#include "core/vector.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"
#include "skin_vulkan/vulkan_buffer.h"
#include "skin_vulkan/vulkan_descriptors.h"
#include "skin_vulkan/vulkan_host.h"
#include "skin_vulkan/vulkan_pipelines.h"
#include "skin_vulkan/vulkan_skin_batches.h"
#include "skin_vulkan/vulkan_skin_rig.h"

#include <array>
#include <memory>
#include <span>

namespace limber {

namespace shaders {
struct SkinRecord;
}

struct VulkanSkinnerOptions {
  uint32_t frames_in_flight = 2;
  // Rig tables by way of a staging copy even where they could be written in place. For tests.
  bool force_staging = false;
  // How many instances a dispatch takes. A device that is a CPU skins one faster when its matrices
  // are at known addresses, and dispatches cost it little; all others take many.
  enum class Dispatch { kAsTheDeviceLikes, kOne, kMany } dispatch = Dispatch::kAsTheDeviceLikes;
};

// Who reads the vertices first; the barrier after the last dispatch makes them visible there, and
// the one before the first write waits for its reads of what was there before. No stage: no such
// barriers; the host waits for compute shader's shader writes itself.
struct SkinConsumer {
  VkPipelineStageFlags stage = VK_PIPELINE_STAGE_VERTEX_INPUT_BIT;
  VkAccessFlags access = VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT;
};

class VulkanSkinner : public NewFromSource {
 public:
  // Errors: kInvalidArgument, kLimitExceeded (too few storage buffers a stage), kDeviceError.
  static Result<std::unique_ptr<VulkanSkinner>> Create(const VulkanHost& host,
                                                       const VulkanSkinnerOptions& options);
  VulkanSkinner(const VulkanSkinner&) = delete;
  VulkanSkinner& operator=(const VulkanSkinner&) = delete;
  // The host has waited for all work that uses it, or the device is lost.
  ~VulkanSkinner();

  // A rig's tables, which the next Record puts in place. Owned by the skinner.
  // Errors: as VulkanSkinRig::Create.
  Result<const VulkanSkinRig*> AddRig(const SkinMesh& mesh, const RigSpace& space);
  // At any time: what frames in flight still use is freed when they are over.
  void RemoveRig(const VulkanSkinRig* rig);

  // Writes the transforms into slot `frame` (below frames_in_flight, whose previous use must have
  // finished on the device) and records the skinning of all that is to be seen in this frame, once
  // a frame, outside a render pass. Leaves the compute pipeline, descriptor sets 0 and 1 and push
  // constants of the compute bind point changed. Two dispatches for each batch (SkinBatches).
  // Allocates nothing once the slots have seen as many instances.
  // Errors, nothing being recorded: kInvalidArgument, kLimitExceeded, kDeviceError.
  Status Record(VkCommandBuffer commands, uint32_t frame, std::span<const VulkanSkinJob> jobs,
                const SkinConsumer& consumer);

  uint32_t frames_in_flight() const { return options_.frames_in_flight; }

  // Of the last Record.
  size_t num_batches() const { return batches_.batches().size(); }

 private:
  // What a frame in flight reads while the next is written.
  struct Slot {
    VulkanBuffer upload;  // matrices and records
    std::unique_ptr<VulkanDescriptors> sets;
    size_t num_sets = 0;
    // Freed when the slot comes round again.
    Vector<VulkanBuffer> old_buffers;
    Vector<std::unique_ptr<VulkanSkinRig>> old_rigs;
  };

  // Where an instance's solve positions of a frame are.
  struct Place {
    uint64_t instance;
    const VulkanSkinRig* rig;
    uint32_t position;  // vec4s into the scratch
    Vec3 origin;
  };

  // Solve positions of one frame, kept for the next.
  struct Scratch {
    VulkanBuffer buffer;
    Vector<Place> places;  // by instance
  };

  VulkanSkinner(const VulkanApi& api, const VulkanSkinnerOptions& options, bool many)
      : api_(api),
        options_(options),
        batches_(api_, many) {}

  Status MakeRoom(Slot* slot);
  void WriteBatch(const SkinBatch& batch, std::span<const VulkanSkinJob> jobs, const Slot& slot,
                  VkDescriptorSet set);
  void BindBatch(const SkinBatch& batch, const BufferRange& last, const Slot& slot,
                 VkDescriptorSet set) const;
  shaders::SkinRecord RecordOf(const SkinBatch& batch, const VulkanSkinJob& job,
                               const BufferRange& last) const;
  // Null: the job wants no last positions, or there are none.
  const Place* FindLast(const VulkanSkinJob& job) const;
  BufferRange LastRange(const SkinBatch& batch, std::span<const VulkanSkinJob> jobs) const;
  void RecordUploads(VkCommandBuffer commands, Slot* slot);
  void RecordPass(VkCommandBuffer commands, const Slot& slot, bool first_pass) const;
  void RecordBarrier(VkCommandBuffer commands, const SkinConsumer& before,
                     const SkinConsumer& after) const;

  Scratch& scratch() { return scratches_[num_frames_ % 2]; }

  const Scratch& last_scratch() const { return scratches_[(num_frames_ + 1) % 2]; }

  VulkanApi api_;
  VulkanSkinnerOptions options_;
  SkinPipelines pipelines_;
  Vector<std::unique_ptr<VulkanSkinRig>> rigs_;
  Vector<Slot> slots_;
  Slot* last_slot_ = nullptr;  // of the last Record
  std::array<Scratch, 2> scratches_;
  uint64_t num_frames_ = 0;
  SkinBatches batches_;
};

}  // namespace limber
