#include "skin_vulkan/vulkan_skin_rig.h"

#include "core/vector.h"
#include "shared/skin_layout.h"
#include "skin/skin_topology.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace limber {
namespace {

static_assert(sizeof(SkinDrawVertex) == sizeof(shaders::SkinDrawVertex));
static_assert(sizeof(SkinCorner) == sizeof(shaders::SkinCorner));
static_assert(offsetof(SkinDrawVertex, handedness) == 24, "third float of the shader's tangent");

template <class T>
std::span<const std::byte> Bytes(const Vector<T>& table) {
  return std::as_bytes(std::span(table));
}

}  // namespace

// The rig's tables as the shaders read them, by binding.
struct VulkanSkinRig::Tables {
  Vector<float> weights;  // [H][V]
  Vector<float> shapes;   // [S][3][V]
  SkinTopology topology;

  Tables(const SkinMesh& mesh, SkinTopology made) : topology(std::move(made)) {
    const size_t num_vertices = mesh.num_solve_vertices;
    const auto num_handles = static_cast<size_t>(mesh.num_handles);
    weights.resize(mesh.weights.size());
    shapes.resize(3 * mesh.shape_positions.size());
    for (size_t v = 0; v < num_vertices; ++v) {
      for (size_t h = 0; h < num_handles; ++h) {
        weights[h * num_vertices + v] = mesh.weights[v * num_handles + h];
      }
    }
    for (size_t i = 0; i < mesh.shape_positions.size(); ++i) {
      const size_t shape = i / num_vertices, v = i % num_vertices;
      for (size_t axis = 0; axis < 3; ++axis) {
        shapes[(shape * 3 + axis) * num_vertices + v] =
            mesh.shape_positions[i][static_cast<int>(axis)];
      }
    }
    if (topology.corners.empty()) topology.corners.emplace_back();
  }

  std::span<const std::byte> ForBinding(uint32_t binding) const {
    switch (binding) {
      case LIMBER_SKIN_WEIGHTS:
        return Bytes(weights);
      case LIMBER_SKIN_SHAPES:
        return Bytes(shapes);
      case LIMBER_SKIN_DRAW_VERTICES:
        return Bytes(topology.draw_vertices);
      case LIMBER_SKIN_GROUP_CORNERS:
        return Bytes(topology.group_corners);
      case LIMBER_SKIN_CORNERS:
        return Bytes(topology.corners);
      default:
        return {};
    }
  }
};

Result<std::unique_ptr<VulkanSkinRig>> VulkanSkinRig::Create(const VulkanApi& api,
                                                             SkinPipelines* pipelines,
                                                             const SkinMesh& mesh,
                                                             const RigSpace& space,
                                                             bool force_staging) {
  std::unique_ptr<VulkanSkinRig> rig(new VulkanSkinRig(api));
  LIMBER_RETURN_IF_ERROR(rig->Initialize(pipelines, mesh, space, force_staging));
  return rig;
}

Status VulkanSkinRig::Initialize(SkinPipelines* pipelines, const SkinMesh& mesh,
                                 const RigSpace& space, bool force_staging) {
  Result<SkinTopology> topology = BuildSkinTopology(mesh, space);
  if (!topology.ok()) return topology.status();
  if (mesh.num_solve_vertices == 0 || mesh.num_draw_vertices == 0) {
    return Error(StatusCode::kMalformed, "skin mesh: has no vertices");
  }
  counts_ = {mesh.num_solve_vertices, mesh.num_draw_vertices,
             static_cast<uint32_t>(mesh.num_handles), static_cast<uint32_t>(mesh.num_shapes)};
  inverse_scale_ = topology->inverse_scale;
  const Tables tables(mesh, std::move(*topology));
  LIMBER_RETURN_IF_ERROR(CheckLimits(tables));
  LIMBER_RETURN_IF_ERROR(
      pipelines->FindPositions(counts_.num_handles, counts_.num_shapes, &positions_));
  return FillTables(tables, pipelines->set_layout(LIMBER_SKIN_SET_RIG), force_staging);
}

Status VulkanSkinRig::CheckLimits(const Tables& tables) const {
  uint64_t largest = std::max(uint64_t{counts_.num_solve_vertices} * 16,
                              uint64_t{counts_.num_handles} * counts_.num_shapes * 48);
  for (uint32_t binding = 0; binding < LIMBER_SKIN_NUM_RIG_BINDINGS; ++binding) {
    largest = std::max(largest, uint64_t{tables.ForBinding(binding).size()});
  }
  if (largest > api_.limits.maxStorageBufferRange) {
    return Error(StatusCode::kLimitExceeded,
                 "vulkan skinner: a table has %llu bytes, the device reads at most %u at once; "
                 "use fewer vertices, handles or shapes",
                 static_cast<unsigned long long>(largest), api_.limits.maxStorageBufferRange);
  }
  const uint32_t most = std::max(counts_.num_solve_vertices, counts_.num_draw_vertices);
  const uint64_t room = uint64_t{api_.limits.maxComputeWorkGroupCount[0]} * LIMBER_SKIN_GROUP_SIZE;
  if (most > room) {
    return Error(StatusCode::kLimitExceeded,
                 "vulkan skinner: %u vertices, the device takes at most %llu in one dispatch", most,
                 static_cast<unsigned long long>(room));
  }
  return {};
}

Status VulkanSkinRig::FillTables(const Tables& tables, VkDescriptorSetLayout layout,
                                 bool force_staging) {
  BufferPlan plan(std::max<VkDeviceSize>(16, api_.limits.minStorageBufferOffsetAlignment));
  std::array<BufferRange, LIMBER_SKIN_NUM_RIG_BINDINGS> ranges;
  for (uint32_t binding = 0; binding < ranges.size(); ++binding)
    ranges[binding] = plan.Add(tables.ForBinding(binding).size());
  // Device-local in any case; written in place where the host sees such memory.
  constexpr VkMemoryPropertyFlags kWritable =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const MemoryWish wish{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                        force_staging ? VkMemoryPropertyFlags{0} : kWritable};
  LIMBER_RETURN_IF_ERROR(
      tables_.Create(api_, plan.size(),
                     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, wish));
  NameVulkanObject(api_, VK_OBJECT_TYPE_BUFFER, VulkanObject(tables_.handle()), "limber rig");
  const bool direct_write = tables_.mapped() != nullptr && !force_staging;
  if (!direct_write) {
    LIMBER_RETURN_IF_ERROR(
        staging_.Create(api_, plan.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, kStagingMemory));
  }
  const VkDescriptorPoolSize of_each{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                     LIMBER_SKIN_NUM_RIG_BINDINGS};
  LIMBER_RETURN_IF_ERROR(sets_.Create(api_, layout, 1, {&of_each, 1}));
  std::byte* target = direct_write ? tables_.mapped() : staging_.mapped();
  std::array<VkDescriptorBufferInfo, LIMBER_SKIN_NUM_RIG_BINDINGS> buffers;
  for (uint32_t binding = 0; binding < ranges.size(); ++binding) {
    const std::span<const std::byte> bytes = tables.ForBinding(binding);
    std::memcpy(target + ranges[binding].offset, bytes.data(), bytes.size());
    buffers[binding] = {tables_.handle(), ranges[binding].offset, ranges[binding].size};
  }
  WriteStorageBuffers(api_, sets_[0], buffers);
  return {};
}

VulkanBuffer VulkanSkinRig::RecordUpload(VkCommandBuffer commands) {
  const VkBufferCopy copy{0, 0, staging_.size()};
  api_.CmdCopyBuffer(commands, staging_.handle(), tables_.handle(), 1, &copy);
  return std::move(staging_);
}

}  // namespace limber
