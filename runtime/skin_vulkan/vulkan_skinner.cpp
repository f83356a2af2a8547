#include "skin_vulkan/vulkan_skinner.h"

#include "shared/skin_layout.h"

#include <algorithm>
#include <cstring>

namespace limber {
namespace {

static_assert(sizeof(SkinDrawVertex) == sizeof(shaders::SkinDrawVertex));
static_assert(sizeof(SkinCorner) == sizeof(shaders::SkinCorner));
static_assert(sizeof(SkinnedVertex) == LIMBER_SKIN_VERTEX_FLOATS * sizeof(float));
static_assert(offsetof(SkinDrawVertex, handedness) == 24, "third float of the shader's tangent");

uint32_t NumWorkGroups(uint32_t count) {
  return count / LIMBER_SKIN_GROUP_SIZE + (count % LIMBER_SKIN_GROUP_SIZE != 0 ? 1 : 0);
}

template <class T>
std::span<const std::byte> Bytes(const std::vector<T>& table) {
  return std::as_bytes(std::span(table));
}

}  // namespace

// The rig's tables as the shaders read them, by binding.
struct VulkanSkinner::Tables {
  std::vector<float> weights;  // [H][V]
  std::vector<float> shapes;   // [S][3][V]
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

VulkanSkinner::~VulkanSkinner() = default;

Result<std::unique_ptr<VulkanSkinner>> VulkanSkinner::Create(const VulkanHost& host,
                                                             const SkinMesh& mesh,
                                                             const RigSpace& space,
                                                             const VulkanSkinnerOptions& options) {
  std::unique_ptr<VulkanSkinner> skinner(new VulkanSkinner());
  skinner->options_ = options;
  LIMBER_RETURN_IF_ERROR(skinner->Initialize(host, mesh, space));
  return skinner;
}

Status VulkanSkinner::Initialize(const VulkanHost& host, const SkinMesh& mesh,
                                 const RigSpace& space) {
  if (options_.frames_in_flight < 1 || options_.frames_in_flight > 16) {
    return Error(StatusCode::kInvalidArgument, "vulkan skinner: %u frames in flight; take 1 to 16",
                 options_.frames_in_flight);
  }
  LIMBER_RETURN_IF_ERROR(LoadVulkanApi(host, &api_));
  Result<SkinTopology> topology = BuildSkinTopology(mesh, space);
  if (!topology.ok()) return topology.status();
  if (mesh.num_solve_vertices == 0 || mesh.num_draw_vertices == 0) {
    return Error(StatusCode::kMalformed, "skin mesh: has no vertices");
  }
  num_solve_vertices_ = mesh.num_solve_vertices;
  num_draw_vertices_ = mesh.num_draw_vertices;
  num_handles_ = static_cast<uint32_t>(mesh.num_handles);
  num_shapes_ = static_cast<uint32_t>(mesh.num_shapes);
  inverse_scale_ = topology->inverse_scale;
  const Tables tables(mesh, std::move(*topology));
  LIMBER_RETURN_IF_ERROR(CheckLimits(tables));

  const uint64_t matrix_bytes = uint64_t{num_handles_} * num_shapes_ * kMatrixBytes;
  matrices_in_storage_ =
      options_.force_matrices_in_storage || matrix_bytes > api_.limits.maxUniformBufferRange;
  SkinPipelineOptions pipeline_options;
  pipeline_options.num_handles = num_handles_;
  pipeline_options.num_shapes = num_shapes_;
  pipeline_options.matrices_in_storage = matrices_in_storage_;
  pipeline_options.cache = host.pipeline_cache;
  LIMBER_RETURN_IF_ERROR(pipelines_.Create(api_, pipeline_options));
  return FillTables(tables);
}

Status VulkanSkinner::CheckLimits(const Tables& tables) const {
  uint64_t largest = std::max({uint64_t{num_draw_vertices_} * sizeof(SkinnedVertex),
                               uint64_t{num_solve_vertices_} * kPositionBytes,
                               uint64_t{num_handles_} * num_shapes_ * kMatrixBytes});
  for (uint32_t binding = 0; binding < LIMBER_SKIN_NUM_BINDINGS; ++binding) {
    largest = std::max(largest, uint64_t{tables.ForBinding(binding).size()});
  }
  if (largest > api_.limits.maxStorageBufferRange) {
    return Error(StatusCode::kLimitExceeded,
                 "vulkan skinner: a table has %llu bytes, the device reads at most %u at once; "
                 "use fewer vertices, handles or shapes",
                 static_cast<unsigned long long>(largest), api_.limits.maxStorageBufferRange);
  }
  const uint32_t groups =
      std::max(NumWorkGroups(num_solve_vertices_), NumWorkGroups(num_draw_vertices_));
  if (groups > api_.limits.maxComputeWorkGroupCount[0]) {
    return Error(StatusCode::kLimitExceeded,
                 "vulkan skinner: %u vertices, the device takes at most %llu in one dispatch",
                 std::max(num_solve_vertices_, num_draw_vertices_),
                 static_cast<unsigned long long>(api_.limits.maxComputeWorkGroupCount[0]) *
                     LIMBER_SKIN_GROUP_SIZE);
  }
  return {};
}

Status VulkanSkinner::FillTables(const Tables& tables) {
  BufferPlan plan(std::max<VkDeviceSize>(16, api_.limits.minStorageBufferOffsetAlignment));
  rig_ranges_.resize(LIMBER_SKIN_NUM_BINDINGS);
  for (uint32_t binding = 0; binding < LIMBER_SKIN_NUM_BINDINGS; ++binding) {
    const size_t bytes = tables.ForBinding(binding).size();
    if (bytes > 0) rig_ranges_[binding] = plan.Add(bytes);
  }
  // Device-local in any case; written in place where the host sees such memory.
  const MemoryWish wish{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                        options_.force_staging
                            ? VkMemoryPropertyFlags{0}
                            : VkMemoryPropertyFlags{VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT}};
  LIMBER_RETURN_IF_ERROR(
      rig_.Create(api_, plan.size(),
                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, wish));
  const bool direct_write = rig_.mapped() != nullptr && !options_.force_staging;
  if (!direct_write) {
    LIMBER_RETURN_IF_ERROR(
        staging_.Create(api_, plan.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, kStagingMemory));
  }
  const VulkanBuffer& target = direct_write ? rig_ : staging_;
  for (uint32_t binding = 0; binding < LIMBER_SKIN_NUM_BINDINGS; ++binding) {
    const std::span<const std::byte> bytes = tables.ForBinding(binding);
    if (bytes.empty()) continue;
    std::memcpy(target.mapped() + rig_ranges_[binding].offset, bytes.data(), bytes.size());
  }
  return target.Flush();
}

void VulkanSkinner::RecordUpload(VkCommandBuffer commands) {
  if (staging_.handle() == VK_NULL_HANDLE) return;
  const VkBufferCopy copy{0, 0, staging_.size()};
  api_.CmdCopyBuffer(commands, staging_.handle(), rig_.handle(), 1, &copy);
  auto barrier = VulkanInfo<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
  api_.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                          VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1, &barrier, 0, nullptr, 0,
                          nullptr);
}

void VulkanSkinner::ReleaseStaging() {
  staging_ = VulkanBuffer();
}

Result<std::unique_ptr<VulkanSkinInstance>> VulkanSkinner::CreateInstance() {
  std::unique_ptr<VulkanSkinInstance> instance(new VulkanSkinInstance(*this));
  LIMBER_RETURN_IF_ERROR(instance->Initialize());
  return instance;
}

Status VulkanSkinner::Record(VkCommandBuffer commands, VulkanSkinInstance* instance, uint32_t frame,
                             const SkinTransforms& transforms, const SkinConsumer& consumer) {
  const size_t expected = size_t{num_handles_} * num_shapes_ * 12;
  if (frame >= options_.frames_in_flight || transforms.matrices.size() != expected) {
    return Error(StatusCode::kInvalidArgument,
                 "vulkan skinner: frame %u of %u, %zu matrix floats, expected %zu", frame,
                 options_.frames_in_flight, transforms.matrices.size(), expected);
  }
  const VulkanSkinInstance::Slot& slot = instance->slots_[frame];
  instance->WriteMatrices(slot, transforms.matrices);
  LIMBER_RETURN_IF_ERROR(instance->matrices_.Flush());
  RecordPasses(commands, *instance, frame, transforms.origin);

  auto barrier = VulkanInfo<VkBufferMemoryBarrier>(VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
  barrier.dstAccessMask = consumer.access;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.buffer = instance->results_.handle();
  barrier.offset = slot.vertices.offset;
  barrier.size = slot.vertices.size;
  api_.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, consumer.stage, 0, 0,
                          nullptr, 1, &barrier, 0, nullptr);
  return {};
}

void VulkanSkinner::RecordPasses(VkCommandBuffer commands, const VulkanSkinInstance& instance,
                                 uint32_t frame, Vec3 origin) {
  const VulkanSkinInstance::Slot& slot = instance.slots_[frame];
  const shaders::SkinPush push{
      {origin.x, origin.y, origin.z}, inverse_scale_, num_solve_vertices_, num_draw_vertices_};
  api_.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines_.positions());
  api_.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines_.layout(), 0, 1,
                             &slot.set, 0, nullptr);
  api_.CmdPushConstants(commands, pipelines_.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(push),
                        &push);
  api_.CmdDispatch(commands, NumWorkGroups(num_solve_vertices_), 1, 1);

  auto barrier = VulkanInfo<VkBufferMemoryBarrier>(VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.buffer = instance.results_.handle();
  barrier.offset = slot.positions.offset;
  barrier.size = slot.positions.size;
  api_.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                          VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, nullptr, 1, &barrier, 0,
                          nullptr);
  api_.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines_.frames());
  api_.CmdDispatch(commands, NumWorkGroups(num_draw_vertices_), 1, 1);
}

}  // namespace limber
