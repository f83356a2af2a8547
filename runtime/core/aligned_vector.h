// Vectors that begin on a cache line, so that no wide load crosses two; large ones, where the
// system has them, in huge pages: tables of a hundred megabytes are read here and there in every
// frame.
#pragma once

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

  CacheLineAllocator() = default;

  template <class Other>
  CacheLineAllocator(const CacheLineAllocator<Other>&) {}  // NOLINT(google-explicit-constructor)

  Number* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(Number)) {
      throw std::bad_array_new_length();
    }
    void* numbers = ::operator new(count * sizeof(Number), Alignment(count));
#ifdef __linux__
    // A wish: where it is not granted nothing is lost.
    if (IsLarge(count)) (void)madvise(numbers, count * sizeof(Number), MADV_HUGEPAGE);
#endif
    return static_cast<Number*>(numbers);
  }

  void deallocate(Number* numbers, std::size_t count) {
    ::operator delete(numbers, Alignment(count));
  }

  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) {
    return true;
  }

 private:
  static constexpr std::size_t kCacheLine = 64, kHugePage = std::size_t{2} << 20;

  static constexpr bool IsLarge(std::size_t count) {
    return count * sizeof(Number) >= 2 * kHugePage;
  }

  static constexpr std::align_val_t Alignment(std::size_t count) {
    return std::align_val_t{IsLarge(count) ? kHugePage : kCacheLine};
  }
};

template <class Number>
using AlignedVector = std::vector<Number, CacheLineAllocator<Number>>;

// What the elements of some vectors take.
template <class... Vectors>
std::size_t BytesOf(const Vectors&... vectors) {
  return ((vectors.size() * sizeof(*vectors.data())) + ... + 0);
}

}  // namespace limber
