#include "host_heap.h"

#include "support/counting_allocator.h"

#include <cstdlib>

namespace limber::test {

void HostHeap::ServeTo(LimberContextDef* def) {
  def->memory_user = this;
  def->allocate = [](void* user, size_t size, size_t alignment) {
    const NotCounted own;
    return static_cast<HostHeap*>(user)->Allocate(size, alignment);
  };
  def->free = [](void* user, void* memory, size_t size, size_t alignment) {
    const NotCounted own;
    static_cast<HostHeap*>(user)->Free(memory, size, alignment);
  };
}

void HostHeap::FailAfter(int64_t count, bool for_good) {
  const std::lock_guard lock(mutex_);
  fail_after_ = count;
  for_good_ = for_good;
  has_failed_ = false;
}

size_t HostHeap::num_live() const {
  const std::lock_guard lock(mutex_);
  return live_.size();
}

int64_t HostHeap::num_made() const {
  const std::lock_guard lock(mutex_);
  return num_made_;
}

int HostHeap::num_wrong() const {
  const std::lock_guard lock(mutex_);
  return num_wrong_;
}

bool HostHeap::HasFailed() const {
  const std::lock_guard lock(mutex_);
  return has_failed_;
}

void* HostHeap::Allocate(size_t size, size_t alignment) {
  const std::lock_guard lock(mutex_);
  if (fail_after_ == 0) {
    if (!for_good_) fail_after_ = -1;
    has_failed_ = true;
    return nullptr;
  }
  if (fail_after_ > 0) --fail_after_;
  ++num_made_;
  auto* block = static_cast<unsigned char*>(
      std::aligned_alloc(2 * alignment, (size + 3 * alignment) / (2 * alignment) * 2 * alignment));
  if (block == nullptr) return nullptr;
  void* memory = block + alignment;
  live_[memory] = {size, alignment, block};
  return memory;
}

void HostHeap::Free(void* memory, size_t size, size_t alignment) {
  const std::lock_guard lock(mutex_);
  const auto found = live_.find(memory);
  if (found == live_.end() || found->second.size != size || found->second.alignment != alignment) {
    ++num_wrong_;
    return;
  }
  std::free(found->second.block);
  live_.erase(found);
}

}  // namespace limber::test
