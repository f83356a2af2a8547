// Memory for numbers that are written before they are read, hundreds of megabytes of them.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace limber::linear {

// Not initialised, and on pages of two megabytes where the system has them: a factor is walked
// through in rows of a kilobyte or two, which with ordinary pages costs as much time in finding the
// pages as in reading them.
class LargeBuffer {
 public:
  // Room for `count` numbers; what was there is lost. Throws std::bad_alloc.
  void Reserve(size_t count) {
    if (count <= capacity_) return;
    numbers_.reset();
    capacity_ = 0;
    const size_t num_pages = (count * sizeof(double) + kPage - 1) / kPage;
    void* memory = std::aligned_alloc(kPage, num_pages * kPage);
    if (memory == nullptr) throw std::bad_alloc();
    numbers_.reset(static_cast<double*>(memory));
    capacity_ = num_pages * kPage / sizeof(double);
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    (void)madvise(memory, num_pages * kPage, MADV_HUGEPAGE);  // a wish: it may be refused
#endif
  }

  double* data() {
    return numbers_.get();
  }

  const double* data() const {
    return numbers_.get();
  }

 private:
  static constexpr size_t kPage = size_t{2} << 20;

  struct Free {
    void operator()(double* memory) const { std::free(memory); }
  };

  std::unique_ptr<double, Free> numbers_;
  size_t capacity_ = 0;
};

}  // namespace limber::linear
