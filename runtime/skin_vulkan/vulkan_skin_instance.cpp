#include "shared/skin_layout.h"
#include "skin_vulkan/vulkan_skinner.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace limber {

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
  const VkBufferUsageFlags matrix_usage = skinner_.matrices_in_storage_
                                              ? VK_BUFFER_USAGE_STORAGE_BUFFER_BIT
                                              : VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
  LIMBER_RETURN_IF_ERROR(matrices_.Create(api, matrix_plan.size(), matrix_usage, kUploadMemory));
  return results_.Create(api, result_plan.size(),
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                             skinner_.options_.extra_vertex_usage,
                         kDeviceMemory);
}

Status VulkanSkinInstance::CreateSets() {
  const VkDescriptorPoolSize of_each[2] = {
      {skinner_.pipelines_.matrices_type(), 1},
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, LIMBER_SKIN_NUM_BINDINGS - 1},
  };
  LIMBER_RETURN_IF_ERROR(
      sets_.Create(skinner_.api_, skinner_.pipelines_.set_layout(), slots_.size(), of_each));
  for (size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].set = sets_[i];
    WriteSet(slots_[i]);
  }
  return {};
}

void VulkanSkinInstance::WriteSet(const Slot& slot) const {
  std::array<VkDescriptorBufferInfo, LIMBER_SKIN_NUM_BINDINGS> buffers{};
  std::array<VkWriteDescriptorSet, LIMBER_SKIN_NUM_BINDINGS> writes{};
  for (uint32_t binding = 0; binding < writes.size(); ++binding) {
    const BufferRange& rig = skinner_.rig_ranges_[binding];
    buffers[binding] = {skinner_.rig_.handle(), rig.offset, rig.size};
    writes[binding] =
        DescriptorWrite(slot.set, binding,
                        binding == LIMBER_SKIN_MATRICES ? skinner_.pipelines_.matrices_type()
                                                        : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
    writes[binding].pBufferInfo = &buffers[binding];
  }
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
