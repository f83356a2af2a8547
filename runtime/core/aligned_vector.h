// Vectors that begin on a cache line, so that no wide load crosses two; large ones, where the
// system has them, in huge pages: tables of a hundred megabytes are read here and there in every
// frame.
#pragma once

#include "core/memory_source.h"

#include <cstddef>
#include <limits>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace limber {

template <class Number>
class CacheLineAllocator {
 public:
  using value_type = Number;

  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;
  using is_always_equal = std::false_type;

  CacheLineAllocator() : source_(CurrentMemorySource()) {}

  template <class Other>
  CacheLineAllocator(const CacheLineAllocator<Other>& other)  // NOLINT(google-explicit-constructor)
      : source_(other.source()) {}

  Number* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(Number)) {
      throw std::bad_array_new_length();
    }
    const std::size_t bytes = count * sizeof(Number);
    void* numbers = AllocateMemory(source_, bytes, Alignment(count));
#ifdef __linux__
    // A wish: where it is not granted nothing is lost.
    if (IsHuge(count)) (void)madvise(numbers, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<Number*>(numbers);
  }

  void deallocate(Number* numbers, std::size_t count) {
    FreeMemory(source_, numbers, count * sizeof(Number), Alignment(count));
  }

  // A copy belongs to whoever makes it.
  CacheLineAllocator select_on_container_copy_construction() const {
    return {};
  }

  const MemorySource* source() const {
    return source_;
  }

  friend bool operator==(const CacheLineAllocator& a, const CacheLineAllocator& b) {
    return a.source_ == b.source_;
  }

 private:
  static constexpr std::size_t kCacheLine = 64, kHugePage = std::size_t{2} << 20;

  // A host's pages are its own affair.
  bool IsHuge(std::size_t count) const {
    return source_ == nullptr && count * sizeof(Number) >= 2 * kHugePage;
  }

  std::size_t Alignment(std::size_t count) const {
    return IsHuge(count) ? kHugePage : kCacheLine;
  }

  const MemorySource* source_;
};

template <class Number>
using AlignedVector = std::vector<Number, CacheLineAllocator<Number>>;

// What the elements of some vectors take.
template <class... Vectors>
std::size_t BytesOf(const Vectors&... vectors) {
  return ((vectors.size() * sizeof(*vectors.data())) + ... + 0);
}

}  // namespace limber
