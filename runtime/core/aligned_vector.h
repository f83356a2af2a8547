// Vectors that begin on a cache line, so that no wide load crosses two.
#pragma once

#include <cstddef>
#include <limits>
#include <new>
#include <vector>

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
    return static_cast<Number*>(::operator new(count * sizeof(Number), kAlignment));
  }

  void deallocate(Number* numbers, std::size_t) { ::operator delete(numbers, kAlignment); }

  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }

 private:
  static constexpr std::align_val_t kAlignment{64};
};

template <class Number>
using AlignedVector = std::vector<Number, CacheLineAllocator<Number>>;

// What the elements of some vectors take.
template <class... Vectors>
std::size_t BytesOf(const Vectors&... vectors) {
  return ((vectors.size() * sizeof(*vectors.data())) + ... + 0);
}

}  // namespace limber
