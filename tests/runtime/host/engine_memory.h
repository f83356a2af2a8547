// The engine's allocator of buffers: pieces of large blocks, as engines have it.
#pragma once

#include "engine_device.h"

#include <memory>
#include <vector>

namespace engine {

class BufferHeap {
 public:
  struct Piece {
    VkBuffer buffer = VK_NULL_HANDLE;
    void* mapped = nullptr;
    size_t block = 0;
  };

  explicit BufferHeap(const Device& device) : device_(device) {}

  BufferHeap(const BufferHeap&) = delete;
  BufferHeap& operator=(const BufferHeap&) = delete;
  ~BufferHeap();

  VkResult Make(const VkBufferCreateInfo& info, VkMemoryPropertyFlags required,
                VkMemoryPropertyFlags preferred, Piece* piece);
  void Free(const Piece& piece);

  // The engine's own buffers: fails the program where there is no memory.
  Piece MakeMapped(VkDeviceSize bytes, VkBufferUsageFlags usage);

  int num_live() const { return num_live_; }

  int num_made() const { return num_made_; }

 private:
  struct Block {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    uint32_t type = 0;
    VkDeviceSize size = 0, used = 0;
    int num_pieces = 0;
    char* mapped = nullptr;
  };

  bool FindType(uint32_t allowed, VkMemoryPropertyFlags flags, uint32_t* type) const;
  VkResult FindRoom(const VkMemoryRequirements& needs, uint32_t type, size_t* block,
                    VkDeviceSize* offset);

  const Device& device_;
  std::vector<Block> blocks_;
  int num_live_ = 0, num_made_ = 0;
};

}  // namespace engine
