// A rig on the device: the tables that its characters share. Immutable once they are uploaded.
#pragma once

#include "core/memory_source.h"
#include "core/status.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"
#include "skin_vulkan/vulkan_buffer.h"
#include "skin_vulkan/vulkan_descriptors.h"
#include "skin_vulkan/vulkan_pipelines.h"

#include <memory>

namespace limber {

struct SkinRigCounts {
  uint32_t num_solve_vertices = 0, num_draw_vertices = 0;
  uint32_t num_handles = 0, num_shapes = 0;

  // Of an instance's matrices.
  uint32_t num_rows() const { return num_handles * num_shapes * 3; }

  size_t num_matrix_floats() const { return size_t{num_rows()} * 4; }
};

class VulkanSkinRig : public NewFromSource {
 public:
  // `force_staging`: in plain device memory, filled from a staging copy, although the device has
  // memory that is device-local and host-visible. Errors: kMalformed (the mesh), kLimitExceeded (a
  // table exceeds maxStorageBufferRange, or the vertices maxComputeWorkGroupCount; the message
  // names it), kDeviceError. `api` must outlive the rig.
  static Result<std::unique_ptr<VulkanSkinRig>> Create(const VulkanApi& api,
                                                       SkinPipelines* pipelines,
                                                       const SkinMesh& mesh, const RigSpace& space,
                                                       bool force_staging);
  VulkanSkinRig(const VulkanSkinRig&) = delete;
  VulkanSkinRig& operator=(const VulkanSkinRig&) = delete;
  ~VulkanSkinRig() = default;

  // False where the tables are in place.
  bool needs_upload() const { return staging_.handle() != VK_NULL_HANDLE; }

  // Records the copy into place and gives the staging buffer away, to be kept until the copy is
  // done. What reads the tables needs a barrier after it.
  VulkanBuffer RecordUpload(VkCommandBuffer commands);

  const SkinRigCounts& counts() const { return counts_; }

  float inverse_scale() const { return inverse_scale_; }

  VkDescriptorSet set() const { return sets_[0]; }

  VkPipeline positions() const { return positions_; }

 private:
  struct Tables;

  explicit VulkanSkinRig(const VulkanApi& api) : api_(api) {}

  Status Initialize(SkinPipelines* pipelines, const SkinMesh& mesh, const RigSpace& space,
                    bool force_staging);
  Status CheckLimits(const Tables& tables) const;
  Status FillTables(const Tables& tables, VkDescriptorSetLayout layout, bool force_staging);

  const VulkanApi& api_;
  SkinRigCounts counts_;
  float inverse_scale_ = 1;
  VulkanBuffer tables_, staging_;
  VulkanDescriptors sets_;
  VkPipeline positions_ = VK_NULL_HANDLE;  // the pipelines'
};

}  // namespace limber
