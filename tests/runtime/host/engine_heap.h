// The engine's heap for what is not on the device: a budget taken from the system at once, handed
// out in pieces of a few sizes.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

namespace engine {

class Heap {
 public:
  explicit Heap(size_t budget);
  Heap(const Heap&) = delete;
  Heap& operator=(const Heap&) = delete;

  // Null where the budget is spent. alignment: a power of two, at most 4096.
  void* Allocate(size_t size, size_t alignment);
  void Free(void* memory, size_t size, size_t alignment);

  int num_live() const;
  int num_made() const;
  // Of the budget, what was ever handed out.
  size_t most_used() const;

 private:
  // Pieces are powers of two, and aligned to their size, or to a page: a small one's next free one
  // is written into it.
  struct FreePiece {
    FreePiece* next;
  };

  static constexpr size_t kSmallest = 5, kSizes = 40;  // as powers of two

  mutable std::mutex mutex_;
  std::vector<unsigned char> room_;
  size_t budget_;
  unsigned char* first_ = nullptr;  // at a page
  size_t used_ = 0;
  FreePiece* free_[kSizes] = {};
  int num_live_ = 0, num_made_ = 0;
};

}  // namespace engine
