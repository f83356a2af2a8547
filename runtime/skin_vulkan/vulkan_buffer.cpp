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
  held_ = std::exchange(other.held_, {});
  memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
  size_ = std::exchange(other.size_, 0);
  return *this;
}

void VulkanBuffer::Destroy() {
  if (api_ == nullptr) return;
  if (api_->host_memory.destroy != nullptr) {
    if (held_.buffer != VK_NULL_HANDLE) api_->host_memory.destroy(api_->host_memory.user, held_);
  } else {
    api_->DestroyBuffer(api_->device, held_.buffer, api_->callbacks);
    api_->FreeMemory(api_->device, memory_, api_->callbacks);  // unmaps
  }
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
  if (api.host_memory.create != nullptr) {
    LIMBER_RETURN_IF_ERROR(made.CreateByHost(info, wish));
  } else {
    LIMBER_RETURN_IF_ERROR(VulkanStatus(
        api.CreateBuffer(api.device, &info, api.callbacks, &made.held_.buffer), "vkCreateBuffer"));
    LIMBER_RETURN_IF_ERROR(made.Allocate(wish));
  }
  *this = std::move(made);
  return {};
}

Status VulkanBuffer::CreateByHost(const VkBufferCreateInfo& info, const MemoryWish& wish) {
  const VulkanHostMemory& memory = api_->host_memory;
  LIMBER_RETURN_IF_ERROR(
      VulkanStatus(memory.create(memory.user, info, wish.required, wish.preferred, &held_),
                   "the host's allocator"));
  const bool must_map = (wish.required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0;
  if (held_.buffer != VK_NULL_HANDLE && (held_.mapped != nullptr || !must_map)) return {};
  return Error(StatusCode::kDeviceError,
               "vulkan: the host's allocator gave a buffer that is null or not mapped");
}

Status VulkanBuffer::Allocate(const MemoryWish& wish) {
  const VulkanApi& api = *api_;
  VkMemoryRequirements needs;
  api.GetBufferMemoryRequirements(api.device, held_.buffer, &needs);
  uint32_t type = 0;
  LIMBER_RETURN_IF_ERROR(ChooseMemoryType(api, needs.memoryTypeBits, wish, &type));
  auto allocate = VulkanInfo<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = type;
  LIMBER_RETURN_IF_ERROR(VulkanStatus(
      api.AllocateMemory(api.device, &allocate, api.callbacks, &memory_), "vkAllocateMemory"));
  LIMBER_RETURN_IF_ERROR(VulkanStatus(api.BindBufferMemory(api.device, held_.buffer, memory_, 0),
                                      "vkBindBufferMemory"));
  // Memory that is visible but not coherent would have to be flushed: it is left unmapped.
  constexpr VkMemoryPropertyFlags kMappable =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  if ((api.memory.memoryTypes[type].propertyFlags & kMappable) != kMappable) return {};
  return VulkanStatus(api.MapMemory(api.device, memory_, 0, VK_WHOLE_SIZE, 0, &held_.mapped),
                      "vkMapMemory");
}

}  // namespace limber
