#include "shared/skin_layout.h"
#include "skin_vulkan/vulkan_skinner.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace limber {

VulkanSkinInstance::~VulkanSkinInstance() {
  skinner_.api_.DestroyDescriptorPool(skinner_.api_.device, pool_, skinner_.api_.callbacks);
}

Status VulkanSkinInstance::Initialize() {
  slots_.resize(skinner_.options_.frames_in_flight);
  LIMBER_RETURN_IF_ERROR(CreateBuffers());
  return CreateSets();
}

SkinnedVertices VulkanSkinInstance::vertices(uint32_t frame) const {
  if (frame >= slots_.size()) return {};
  return {results_.handle(), slots_[frame].vertices.offset, slots_[frame].vertices.size};
}

Status VulkanSkinInstance::CreateBuffers() {
  const VulkanApi& api = skinner_.api_;
  const VkDeviceSize guard = skinner_.options_.guard_bytes;
  // 256 is the largest offset alignment that Vulkan allows a device to ask for.
  BufferPlan matrix_plan(256), result_plan(256);
  for (Slot& slot : slots_) {
    slot.matrices = matrix_plan.Add(VkDeviceSize{skinner_.num_handles_} * skinner_.num_shapes_ *
                                    VulkanSkinner::kMatrixBytes);
    if (guard > 0) result_plan.Add(guard);
    slot.positions =
        result_plan.Add(VkDeviceSize{skinner_.num_solve_vertices_} * VulkanSkinner::kPositionBytes);
    if (guard > 0) result_plan.Add(guard);
    slot.vertices =
        result_plan.Add(VkDeviceSize{skinner_.num_draw_vertices_} * sizeof(SkinnedVertex));
    if (guard > 0) result_plan.Add(guard);
  }
  Result<VulkanBuffer> matrices = VulkanBuffer::Create(
      api, matrix_plan.size(),
      skinner_.matrices_in_storage_ ? VK_BUFFER_USAGE_STORAGE_BUFFER_BIT
                                    : VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT,
      VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (!matrices.ok()) return matrices.status();
  matrices_ = std::move(*matrices);
  Result<VulkanBuffer> results =
      VulkanBuffer::Create(api, result_plan.size(),
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                               skinner_.options_.extra_vertex_usage,
                           0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (!results.ok()) return results.status();
  results_ = std::move(*results);
  return {};
}

Status VulkanSkinInstance::CreateSets() {
  const VulkanApi& api = skinner_.api_;
  const auto num_slots = static_cast<uint32_t>(slots_.size());
  const VkDescriptorPoolSize sizes[2] = {
      {skinner_.pipelines_.matrices_type(), num_slots},
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, num_slots * (LIMBER_SKIN_NUM_BINDINGS - 1)},
  };
  auto pool_info =
      VulkanInfo<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool_info.maxSets = num_slots;
  pool_info.poolSizeCount = 2;
  pool_info.pPoolSizes = sizes;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(api.CreateDescriptorPool(api.device, &pool_info, api.callbacks, &pool_),
                   "vkCreateDescriptorPool"));
  const VkDescriptorSetLayout layout = skinner_.pipelines_.set_layout();
  for (Slot& slot : slots_) {
    auto info =
        VulkanInfo<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
    info.descriptorPool = pool_;
    info.descriptorSetCount = 1;
    info.pSetLayouts = &layout;
    LIMBER_RETURN_IF_ERROR(VulkanStatus(api.AllocateDescriptorSets(api.device, &info, &slot.set),
                                        "vkAllocateDescriptorSets"));
    WriteSet(slot);
  }
  return {};
}

void VulkanSkinInstance::WriteSet(const Slot& slot) const {
  std::array<VkDescriptorBufferInfo, LIMBER_SKIN_NUM_BINDINGS> buffers{};
  std::array<VkWriteDescriptorSet, LIMBER_SKIN_NUM_BINDINGS> writes{};
  for (uint32_t binding = 0; binding < writes.size(); ++binding) {
    const BufferRange& rig = skinner_.rig_ranges_[binding];
    buffers[binding] = {skinner_.rig_.handle(), rig.offset, rig.size};
    writes[binding].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[binding].dstSet = slot.set;
    writes[binding].dstBinding = binding;
    writes[binding].descriptorCount = 1;
    writes[binding].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[binding].pBufferInfo = &buffers[binding];
  }
  writes[LIMBER_SKIN_MATRICES].descriptorType = skinner_.pipelines_.matrices_type();
  buffers[LIMBER_SKIN_MATRICES] = {matrices_.handle(), slot.matrices.offset, slot.matrices.size};
  buffers[LIMBER_SKIN_SOLVE_POSITIONS] = {results_.handle(), slot.positions.offset,
                                          slot.positions.size};
  buffers[LIMBER_SKIN_VERTICES] = {results_.handle(), slot.vertices.offset, slot.vertices.size};
  skinner_.api_.UpdateDescriptorSets(skinner_.api_.device, static_cast<uint32_t>(writes.size()),
                                     writes.data(), 0, nullptr);
}

// Copies the matrices as they are, but for the translations: their sum over the shapes goes into
// shape 0, so that the shader need not add one in every step.
void VulkanSkinInstance::WriteMatrices(const Slot& slot, std::span<const float> matrices) {
  auto* out = reinterpret_cast<float*>(matrices_.mapped() + slot.matrices.offset);
  const size_t handle_floats = size_t{skinner_.num_shapes_} * 12;
  for (size_t begin = 0; begin < matrices.size(); begin += handle_floats) {
    float sums[3] = {};
    for (size_t i = begin; i < begin + handle_floats; i += 12) {
      for (size_t row = 0; row < 3; ++row)
        sums[row] += matrices[i + row * 4 + 3];
    }
    // Mapped memory may be uncached: written in order, never read.
    std::memcpy(out + begin, matrices.data() + begin, handle_floats * sizeof(float));
    for (size_t row = 0; row < 3; ++row)
      out[begin + row * 4 + 3] = sums[row];
  }
}

}  // namespace limber
