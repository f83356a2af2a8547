#include "engine_memory.h"

#include <algorithm>
#include <cstdlib>

namespace engine {
namespace {

constexpr VkDeviceSize kBlockBytes = 32 << 20;

}  // namespace

BufferHeap::~BufferHeap() {
  for (const Block& block : blocks_)
    vkFreeMemory(device_.device, block.memory, nullptr);
}

bool BufferHeap::FindType(uint32_t allowed, VkMemoryPropertyFlags flags, uint32_t* type) const {
  for (uint32_t i = 0; i < device_.memory.memoryTypeCount; ++i) {
    if ((allowed >> i & 1) == 0) continue;
    if ((device_.memory.memoryTypes[i].propertyFlags & flags) != flags) continue;
    *type = i;
    return true;
  }
  return false;
}

VkResult BufferHeap::FindRoom(const VkMemoryRequirements& needs, uint32_t type, size_t* block,
                              VkDeviceSize* offset) {
  for (*block = 0; *block < blocks_.size(); ++*block) {
    Block& b = blocks_[*block];
    *offset = (b.used + needs.alignment - 1) / needs.alignment * needs.alignment;
    if (b.type == type && *offset + needs.size <= b.size) return VK_SUCCESS;
  }
  Block made;
  made.type = type;
  made.size = std::max(kBlockBytes, needs.size);
  auto info = Tagged<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  info.allocationSize = made.size;
  info.memoryTypeIndex = type;
  const VkResult result = vkAllocateMemory(device_.device, &info, nullptr, &made.memory);
  if (result != VK_SUCCESS) return result;
  constexpr VkMemoryPropertyFlags kMappable =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  if ((device_.memory.memoryTypes[type].propertyFlags & kMappable) == kMappable) {
    void* mapped = nullptr;
    vkMapMemory(device_.device, made.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    made.mapped = static_cast<char*>(mapped);
  }
  blocks_.push_back(made);
  *offset = 0;
  return VK_SUCCESS;
}

VkResult BufferHeap::Make(const VkBufferCreateInfo& info, VkMemoryPropertyFlags required,
                          VkMemoryPropertyFlags preferred, Piece* piece) {
  const VkResult created = vkCreateBuffer(device_.device, &info, nullptr, &piece->buffer);
  if (created != VK_SUCCESS) return created;
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device_.device, piece->buffer, &needs);
  uint32_t type = 0;
  VkDeviceSize offset = 0;
  const bool found = FindType(needs.memoryTypeBits, required | preferred, &type) ||
                     FindType(needs.memoryTypeBits, required, &type);
  const VkResult result =
      found ? FindRoom(needs, type, &piece->block, &offset) : VK_ERROR_OUT_OF_DEVICE_MEMORY;
  if (result != VK_SUCCESS) {
    vkDestroyBuffer(device_.device, piece->buffer, nullptr);
    return result;
  }
  Block& block = blocks_[piece->block];
  vkBindBufferMemory(device_.device, piece->buffer, block.memory, offset);
  block.used = offset + needs.size;
  ++block.num_pieces;
  ++num_live_;
  ++num_made_;
  piece->mapped = block.mapped == nullptr ? nullptr : block.mapped + offset;
  return VK_SUCCESS;
}

void BufferHeap::Free(const Piece& piece) {
  vkDestroyBuffer(device_.device, piece.buffer, nullptr);
  Block& block = blocks_[piece.block];
  --num_live_;
  if (--block.num_pieces == 0) block.used = 0;  // the block starts again
}

BufferHeap::Piece BufferHeap::MakeMapped(VkDeviceSize bytes, VkBufferUsageFlags usage) {
  auto info = Tagged<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = bytes;
  info.usage = usage;
  Piece piece;
  constexpr VkMemoryPropertyFlags kMappable =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  if (Make(info, kMappable, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &piece) != VK_SUCCESS)
    std::abort();
  return piece;
}

}  // namespace engine
