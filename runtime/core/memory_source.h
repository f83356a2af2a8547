// Where memory comes from: the heap, or an allocator of the host's for all that is made while a
// MemoryScope names it. What was made there goes back there, on whichever thread and whenever.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

namespace limber {

// A host's allocator. Both functions may be called by several threads at once.
struct MemorySource {
  // Memory of that size, at a multiple of `alignment` (a power of two); null where there is none.
  void* (*allocate)(void* user, std::size_t size, std::size_t alignment) = nullptr;
  // Takes it back; size and alignment are those that it was asked for with.
  void (*free)(void* user, void* memory, std::size_t size, std::size_t alignment) = nullptr;
  void* user = nullptr;
};

// That of the thread's innermost MemoryScope; null: the heap.
const MemorySource* CurrentMemorySource();

// While it lives, what its thread makes comes from `source` (null: the heap), which must live as
// long as anything that was made there.
class MemoryScope {
 public:
  explicit MemoryScope(const MemorySource* source);
  MemoryScope(const MemoryScope&) = delete;
  MemoryScope& operator=(const MemoryScope&) = delete;
  ~MemoryScope();

 private:
  const MemorySource* before_;
};

// Throws std::bad_alloc, also where a host gives memory that is not aligned as asked. size > 0.
void* AllocateMemory(const MemorySource* source, std::size_t size, std::size_t alignment);
void FreeMemory(const MemorySource* source, void* memory, std::size_t size, std::size_t alignment);

// A base for what `new` and std::make_unique make: its memory comes from the source of the moment,
// which is written down in front of it.
struct NewFromSource {
  static void* operator new(std::size_t size);
  static void* operator new(std::size_t size, std::align_val_t alignment);
  static void operator delete(void* memory, std::size_t size);
  static void operator delete(void* memory, std::size_t size, std::align_val_t alignment);
};

// For containers. It remembers the source of the moment when the container was made.
template <class T>
class Allocator {
 public:
  using value_type = T;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;
  using is_always_equal = std::false_type;

  Allocator() : source_(CurrentMemorySource()) {}

  template <class Other>
  Allocator(const Allocator<Other>& other)  // NOLINT(google-explicit-constructor): as std asks
      : source_(other.source()) {}

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(AllocateMemory(source_, count * sizeof(T), alignof(T)));
  }

  void deallocate(T* memory, std::size_t count) {
    FreeMemory(source_, memory, count * sizeof(T), alignof(T));
  }

  // A copy belongs to whoever makes it.
  Allocator select_on_container_copy_construction() const { return {}; }

  const MemorySource* source() const { return source_; }

  friend bool operator==(const Allocator& a, const Allocator& b) { return a.source_ == b.source_; }

 private:
  const MemorySource* source_;
};

template <class T, class... Arguments>
std::shared_ptr<T> MakeShared(Arguments&&... arguments) {
  return std::allocate_shared<T>(Allocator<T>(), std::forward<Arguments>(arguments)...);
}

// For an object that only `new` can make; T is a NewFromSource.
template <class T>
std::shared_ptr<T> Share(T* object) {
  return std::shared_ptr<T>(object, std::default_delete<T>(), Allocator<T>());
}

}  // namespace limber
