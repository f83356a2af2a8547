#include "support/counting_allocator.h"

#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

thread_local int64_t allocation_count = 0;
thread_local int64_t allocated_bytes = 0;
thread_local int64_t freed_count = 0;

void Count(std::size_t size) {
  ++allocation_count;
  allocated_bytes += static_cast<int64_t>(size);
}

}  // namespace

namespace limber::test {
int64_t AllocationCount() {
  return allocation_count;
}

int64_t AllocatedBytes() {
  return allocated_bytes;
}

int64_t LiveAllocations() {
  return allocation_count - freed_count;
}

NotCounted::NotCounted() : count_(allocation_count), bytes_(allocated_bytes), freed_(freed_count) {}

NotCounted::~NotCounted() {
  allocation_count = count_;
  allocated_bytes = bytes_;
  freed_count = freed_;
}

}  // namespace limber::test

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

namespace {

void* CountedAllocate(std::size_t size, std::size_t alignment) {
  Count(size);
  if (size == 0) size = 1;
  void* memory =
      alignment <= alignof(std::max_align_t)
          ? std::malloc(size)
          : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void CountedFree(void* memory) {
  if (memory != nullptr) ++freed_count;
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  return CountedAllocate(size, 0);
}

void* operator new[](std::size_t size) {
  return CountedAllocate(size, 0);
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  return CountedAllocate(size, static_cast<std::size_t>(alignment));
}

void* operator new[](std::size_t size, std::align_val_t alignment) {
  return CountedAllocate(size, static_cast<std::size_t>(alignment));
}

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  Count(size);
  return std::malloc(size == 0 ? 1 : size);
}

void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  Count(size);
  return std::malloc(size == 0 ? 1 : size);
}

void operator delete(void* memory, const std::nothrow_t&) noexcept {
  CountedFree(memory);
}

void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  CountedFree(memory);
}

void operator delete(void* memory) noexcept {
  CountedFree(memory);
}

void operator delete[](void* memory) noexcept {
  CountedFree(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  CountedFree(memory);
}

void operator delete[](void* memory, std::size_t) noexcept {
  CountedFree(memory);
}

void operator delete(void* memory, std::align_val_t) noexcept {
  CountedFree(memory);
}

void operator delete[](void* memory, std::align_val_t) noexcept {
  CountedFree(memory);
}

void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  CountedFree(memory);
}

void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  CountedFree(memory);
}

#else

// The C library's own entry points under the public names: operator new comes through here too.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  Count(size);
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  Count(count * size);
  return __libc_calloc(count, size);
}

void* realloc(void* memory, std::size_t size) {
  Count(size);
  if (memory != nullptr) ++freed_count;
  return __libc_realloc(memory, size);
}

void free(void* memory) {
  if (memory != nullptr) ++freed_count;
  __libc_free(memory);
}

void* memalign(std::size_t alignment, std::size_t size) {
  Count(size);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  Count(size);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  Count(size);
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? 12 : 0;  // ENOMEM
}
}

#endif
