#include "skin_vulkan/vulkan_buffer.h"

#include <utility>

namespace limber {
namespace {

bool FindMemoryType(const VulkanApi& api, uint32_t allowed, VkMemoryPropertyFlags flags,
                    uint32_t* type) {
  for (uint32_t i = 0; i < api.memory.memoryTypeCount; ++i) {
    if ((allowed >> i & 1) != 0 && (api.memory.memoryTypes[i].propertyFlags & flags) == flags) {
      *type = i;
      return true;
    }
  }
  return false;
}

}  // namespace

Status ChooseMemoryType(const VulkanApi& api, uint32_t allowed, const MemoryWish& wish,
                        uint32_t* type) {
  if (FindMemoryType(api, allowed, wish.required | wish.preferred, type) ||
      FindMemoryType(api, allowed, wish.required, type)) {
    return {};
  }
  return Error(StatusCode::kDeviceError, "vulkan: no memory type has the properties 0x%x",
               wish.required);
}

BufferRange BufferPlan::Add(VkDeviceSize bytes) {
  const VkDeviceSize offset = (end_ + alignment_ - 1) & ~(alignment_ - 1);
  end_ = offset + bytes;
  return {offset, bytes};
}

VulkanBuffer& VulkanBuffer::operator=(VulkanBuffer&& other) noexcept {
  if (this == &other) return *this;
  Destroy();
  api_ = std::exchange(other.api_, nullptr);
  buffer_ = std::exchange(other.buffer_, VK_NULL_HANDLE);
  memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
  size_ = std::exchange(other.size_, 0);
  mapped_ = std::exchange(other.mapped_, nullptr);
  coherent_ = other.coherent_;
  return *this;
}

void VulkanBuffer::Destroy() {
  if (api_ == nullptr) return;
  api_->DestroyBuffer(api_->device, buffer_, api_->callbacks);
  api_->FreeMemory(api_->device, memory_, api_->callbacks);  // unmaps
  api_ = nullptr;
}

Status VulkanBuffer::Create(const VulkanApi& api, VkDeviceSize size, VkBufferUsageFlags usage,
                            const MemoryWish& wish) {
  VulkanBuffer made;  // freed on the way out of an error
  made.api_ = &api;
  made.size_ = size;
  *this = VulkanBuffer();
  auto info = VulkanInfo<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = size;
  info.usage = usage;
  info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      api.CreateBuffer(api.device, &info, api.callbacks, &made.buffer_), "vkCreateBuffer"));
  LIMBER_RETURN_IF_ERROR(made.Allocate(wish));
  *this = std::move(made);
  return {};
}

Status VulkanBuffer::Allocate(const MemoryWish& wish) {
  const VulkanApi& api = *api_;
  VkMemoryRequirements needs;
  api.GetBufferMemoryRequirements(api.device, buffer_, &needs);
  uint32_t type = 0;
  LIMBER_RETURN_IF_ERROR(ChooseMemoryType(api, needs.memoryTypeBits, wish, &type));
  auto allocate = VulkanInfo<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = type;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      api.AllocateMemory(api.device, &allocate, api.callbacks, &memory_), "vkAllocateMemory"));
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(api.BindBufferMemory(api.device, buffer_, memory_, 0), "vkBindBufferMemory"));

  const VkMemoryPropertyFlags flags = api.memory.memoryTypes[type].propertyFlags;
  coherent_ = (flags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT) != 0;
  if ((flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) == 0) return {};
  void* mapped = nullptr;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      api.MapMemory(api.device, memory_, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory"));
  mapped_ = static_cast<std::byte*>(mapped);
  return {};
}

Status VulkanBuffer::Flush() const {
  if (coherent_ || mapped_ == nullptr) return {};
  auto range = VulkanInfo<VkMappedMemoryRange>(VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE);
  range.memory = memory_;
  range.size = VK_WHOLE_SIZE;
  return VulkanStatus(api_->FlushMappedMemoryRanges(api_->device, 1, &range),
                      "vkFlushMappedMemoryRanges");
}

}  // namespace limber
