// Descriptor sets of one layout, with a pool of their own that is freed with them.
#pragma once

#include "core/memory_source.h"
#include "core/vector.h"
#include "skin_vulkan/vulkan_api.h"

#include <span>

namespace limber {

class VulkanDescriptors : public NewFromSource {
 public:
  VulkanDescriptors() = default;
  VulkanDescriptors(const VulkanDescriptors&) = delete;
  VulkanDescriptors& operator=(const VulkanDescriptors&) = delete;
  ~VulkanDescriptors();

  // `count` sets (none is allowed) of `layout`; `of_each` says what one set holds. Once. `api` must
  // outlive the object. Errors: kDeviceError.
  Status Create(const VulkanApi& api, VkDescriptorSetLayout layout, size_t count,
                std::span<const VkDescriptorPoolSize> of_each);

  VkDescriptorSet operator[](size_t index) const { return sets_[index]; }

 private:
  const VulkanApi* api_ = nullptr;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  Vector<VkDescriptorSet> sets_;
};

// Puts buffers at the bindings 0, 1, ... of a set of storage buffers.
void WriteStorageBuffers(const VulkanApi& api, VkDescriptorSet set,
                         std::span<const VkDescriptorBufferInfo> buffers);

// Writes one descriptor of a set; the caller adds pBufferInfo or pImageInfo.
VkWriteDescriptorSet DescriptorWrite(VkDescriptorSet set, uint32_t binding, VkDescriptorType type);

}  // namespace limber
