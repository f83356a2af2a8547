// Eq. 6, normals and tangents as Vulkan compute, recorded into the host's command buffer.
//
//   VulkanSkinner      one per character kind: pipelines and immutable buffers (shared)
//   VulkanSkinInstance one per character on screen: matrices and results, one slot a frame in
//   flight
//
// Nothing here submits or waits. Calls on one object come from one thread at a time; objects are
// independent of each other. Needs Vulkan 1.1 and nothing more.
#pragma once

#include "core/status.h"
#include "rig/rig_tables.h"
#include "rig/skin_mesh.h"
#include "skin/skin_topology.h"
#include "skin/skin_transforms.h"
#include "skin_vulkan/vulkan_buffer.h"
#include "skin_vulkan/vulkan_descriptors.h"
#include "skin_vulkan/vulkan_host.h"
#include "skin_vulkan/vulkan_pipelines.h"

#include <memory>
#include <vector>

namespace limber {

// One vertex as the skinner writes it, 40 bytes; attribute formats in brackets.
struct SkinnedVertex {
  float position[3];  // mesh space                     [R32G32B32_SFLOAT, offset 0]
  float normal[3];    // unit                           [R32G32B32_SFLOAT, offset 12]
  float tangent[4];   // unit, orthogonal to normal; handedness [R32G32B32A32_SFLOAT, offset 24]
};

static_assert(sizeof(SkinnedVertex) == 40);

// Where a frame's vertices lie: bind at `offset` as a vertex buffer, draw vertex order.
struct SkinnedVertices {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0, size = 0;
};

struct VulkanSkinnerOptions {
  uint32_t frames_in_flight = 2;
  // Rig buffers in plain device memory, filled by RecordUpload from a staging copy, although the
  // device has memory that is device-local and host-visible. For tests.
  bool force_staging = false;
  // Matrices in a storage buffer even where a uniform buffer could hold them. For tests.
  bool force_matrices_in_storage = false;
  // More usages for the buffers of the results, for example transfer source (to read back).
  VkBufferUsageFlags extra_vertex_usage = 0;
  // Guards of this many bytes around each range of an instance. For tests.
  VkDeviceSize guard_bytes = 0;
};

// Who reads the results first; the barrier after the last dispatch makes them visible there.
struct SkinConsumer {
  VkPipelineStageFlags stage = VK_PIPELINE_STAGE_VERTEX_INPUT_BIT;
  VkAccessFlags access = VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT;
};

class VulkanSkinInstance;

class VulkanSkinner {
 public:
  // Errors: kMalformed (the mesh), kLimitExceeded (a table exceeds maxStorageBufferRange, or the
  // vertices maxComputeWorkGroupCount; the message names it), kDeviceError, kInvalidArgument.
  static Result<std::unique_ptr<VulkanSkinner>> Create(const VulkanHost& host, const SkinMesh& mesh,
                                                       const RigSpace& space,
                                                       const VulkanSkinnerOptions& options);
  VulkanSkinner(const VulkanSkinner&) = delete;
  VulkanSkinner& operator=(const VulkanSkinner&) = delete;
  // The host has waited for all work that uses it; instances are gone.
  ~VulkanSkinner();

  // Records the copy of the rig's tables; once, before the first Record, outside a render pass.
  // Where the tables are already in place it records nothing.
  void RecordUpload(VkCommandBuffer commands);
  // Frees the staging copy; call when the upload has finished on the device.
  void ReleaseStaging();

  // Buffers for one character. Errors: kLimitExceeded, kDeviceError.
  Result<std::unique_ptr<VulkanSkinInstance>> CreateInstance();

  // Writes the matrices into slot `frame` (below frames_in_flight, whose previous use must have
  // finished on the device) and records both passes, outside a render pass. Leaves the compute
  // pipeline, descriptor set 0 and push constants of the compute bind point changed, and the
  // slot's vertices visible to `consumer`. Errors: kInvalidArgument (frame, matrix count).
  Status Record(VkCommandBuffer commands, VulkanSkinInstance* instance, uint32_t frame,
                const SkinTransforms& transforms, const SkinConsumer& consumer);

  uint32_t num_draw_vertices() const { return num_draw_vertices_; }

  uint32_t frames_in_flight() const { return options_.frames_in_flight; }

  bool matrices_in_storage() const { return matrices_in_storage_; }

 private:
  friend class VulkanSkinInstance;
  struct Tables;
  static constexpr uint32_t kMatrixBytes = 48, kPositionBytes = 16;  // 3 vec4, 1 vec4

  VulkanSkinner() = default;
  Status Initialize(const VulkanHost& host, const SkinMesh& mesh, const RigSpace& space);
  Status CheckLimits(const Tables& tables) const;
  Status FillTables(const Tables& tables);
  void RecordPasses(VkCommandBuffer commands, const VulkanSkinInstance& instance, uint32_t frame,
                    Vec3 origin);

  VulkanApi api_;
  VulkanSkinnerOptions options_;
  SkinPipelines pipelines_;
  VulkanBuffer rig_, staging_;
  std::vector<BufferRange> rig_ranges_;  // by binding; empty for those of the instance
  uint32_t num_solve_vertices_ = 0, num_draw_vertices_ = 0;
  uint32_t num_handles_ = 0, num_shapes_ = 0;
  float inverse_scale_ = 1;
  bool matrices_in_storage_ = false;
};

class VulkanSkinInstance {
 public:
  VulkanSkinInstance(const VulkanSkinInstance&) = delete;
  VulkanSkinInstance& operator=(const VulkanSkinInstance&) = delete;

  // The vertices of slot `frame`, as the last Record of that slot leaves them.
  SkinnedVertices vertices(uint32_t frame) const;

  // The whole device buffer of results (vertices and solve positions of every slot); for tests.
  VkBuffer result_buffer() const { return results_.handle(); }

  VkDeviceSize result_size() const { return results_.size(); }

 private:
  friend class VulkanSkinner;

  struct Slot {
    BufferRange matrices, positions, vertices;
    VkDescriptorSet set = VK_NULL_HANDLE;
  };

  explicit VulkanSkinInstance(const VulkanSkinner& skinner) : skinner_(skinner) {}

  Status Initialize();
  Status CreateBuffers();
  Status CreateSets();
  void WriteSet(const Slot& slot) const;
  void WriteMatrices(const Slot& slot, std::span<const float> matrices);

  const VulkanSkinner& skinner_;
  VulkanBuffer matrices_, results_;
  VulkanDescriptors sets_;
  std::vector<Slot> slots_;
};

}  // namespace limber
