#include "skin_vulkan/vulkan_descriptors.h"

#include "core/vector.h"

namespace limber {

VulkanDescriptors::~VulkanDescriptors() {
  if (api_ == nullptr) return;
  api_->DestroyDescriptorPool(api_->device, pool_, api_->callbacks);
}

Status VulkanDescriptors::Create(const VulkanApi& api, VkDescriptorSetLayout layout, size_t count,
                                 std::span<const VkDescriptorPoolSize> of_each) {
  if (count == 0) return {};
  api_ = &api;
  const auto num_sets = static_cast<uint32_t>(count);
  Vector<VkDescriptorPoolSize> sizes(of_each.begin(), of_each.end());
  for (VkDescriptorPoolSize& size : sizes)
    size.descriptorCount *= num_sets;
  auto pool = VulkanInfo<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool.maxSets = num_sets;
  pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(api.CreateDescriptorPool(api.device, &pool, api.callbacks, &pool_),
                   "vkCreateDescriptorPool"));
  const Vector<VkDescriptorSetLayout> layouts(count, layout);
  auto info =
      VulkanInfo<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pool_;
  info.descriptorSetCount = num_sets;
  info.pSetLayouts = layouts.data();
  sets_.resize(count);
  return VulkanStatus(api.AllocateDescriptorSets(api.device, &info, sets_.data()),
                      "vkAllocateDescriptorSets");
}

VkWriteDescriptorSet DescriptorWrite(VkDescriptorSet set, uint32_t binding, VkDescriptorType type) {
  auto write = VulkanInfo<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
  write.dstSet = set;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = type;
  return write;
}

void WriteStorageBuffers(const VulkanApi& api, VkDescriptorSet set,
                         std::span<const VkDescriptorBufferInfo> buffers) {
  auto write = DescriptorWrite(set, 0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  write.descriptorCount = static_cast<uint32_t>(buffers.size());  // goes on at the next binding
  write.pBufferInfo = buffers.data();
  api.UpdateDescriptorSets(api.device, 1, &write, 0, nullptr);
}

}  // namespace limber
