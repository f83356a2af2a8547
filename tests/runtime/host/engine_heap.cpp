#include "engine_heap.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace engine {
namespace {

constexpr size_t kPage = 4096;

size_t RoundUp(size_t size, size_t alignment) {
  return (size + alignment - 1) / alignment * alignment;
}

}  // namespace

Heap::Heap(size_t budget) : room_(budget + kPage), budget_(budget) {
  const auto address = reinterpret_cast<uintptr_t>(room_.data());
  first_ = room_.data() + (RoundUp(address, kPage) - address);
}

void* Heap::Allocate(size_t size, size_t alignment) {
  const size_t power = std::max(kSmallest, size_t(std::bit_width(std::max(size, alignment) - 1)));
  const std::lock_guard lock(mutex_);
  if (power >= kSizes || alignment > kPage) return nullptr;
  void* piece = free_[power];
  if (piece != nullptr) {
    free_[power] = free_[power]->next;
  } else {
    const size_t bytes = size_t{1} << power;
    const size_t begin = RoundUp(used_, std::min(bytes, kPage));
    if (begin > budget_ || bytes > budget_ - begin) return nullptr;
    piece = first_ + begin;
    used_ = begin + bytes;
  }
  ++num_live_;
  ++num_made_;
  return piece;
}

void Heap::Free(void* memory, size_t size, size_t alignment) {
  const size_t power = std::max(kSmallest, size_t(std::bit_width(std::max(size, alignment) - 1)));
  const std::lock_guard lock(mutex_);
  free_[power] = new (memory) FreePiece{free_[power]};
  --num_live_;
}

int Heap::num_live() const {
  const std::lock_guard lock(mutex_);
  return num_live_;
}

int Heap::num_made() const {
  const std::lock_guard lock(mutex_);
  return num_made_;
}

size_t Heap::most_used() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

}  // namespace engine
