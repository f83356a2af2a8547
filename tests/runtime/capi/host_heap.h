// A host's allocator for tests: knows every piece that is out, and can refuse one.
#pragma once

#include "limber/limber.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

namespace limber::test {

class HostHeap {
 public:
  // Hands out memory at odd multiples of the alignment, so that nothing is aligned by luck. What it
  // does is not counted (support/counting_allocator.h).
  HostHeap() = default;
  HostHeap(const HostHeap&) = delete;
  HostHeap& operator=(const HostHeap&) = delete;

  // Lets Limber use it.
  void ServeTo(LimberContextDef* def);

  // The allocation after that many more fails, and all that follow where `for_good`; -1: none.
  void FailAfter(int64_t count, bool for_good);

  size_t num_live() const;
  int64_t num_made() const;
  // Pieces that came back with another size or alignment, or that were not out.
  int num_wrong() const;
  // Since FailAfter.
  bool HasFailed() const;

 private:
  struct Piece {
    size_t size, alignment;
    void* block;
  };

  void* Allocate(size_t size, size_t alignment);
  void Free(void* memory, size_t size, size_t alignment);

  mutable std::mutex mutex_;
  std::map<void*, Piece> live_;
  int64_t num_made_ = 0, fail_after_ = -1;
  bool for_good_ = false, has_failed_ = false;
  int num_wrong_ = 0;
};

}  // namespace limber::test
