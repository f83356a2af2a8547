#include "core/memory_source.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace limber {
namespace {

constinit thread_local const MemorySource* current = nullptr;

constexpr std::size_t kPointerSize = sizeof(void*);

// The source's place in front of an object.
constexpr std::size_t HeadOf(std::size_t alignment) {
  return std::max(alignment, kPointerSize);
}

void* NewWithHead(std::size_t size, std::size_t alignment) {
  const MemorySource* source = CurrentMemorySource();
  const std::size_t head = HeadOf(alignment);
  auto* memory = static_cast<unsigned char*>(AllocateMemory(source, head + size, alignment));
  std::memcpy(memory + head - kPointerSize, &source, kPointerSize);
  return memory + head;
}

void DeleteWithHead(void* object, std::size_t size, std::size_t alignment) {
  if (object == nullptr) return;
  const MemorySource* source = nullptr;
  const std::size_t head = HeadOf(alignment);
  auto* bytes = static_cast<unsigned char*>(object);
  std::memcpy(&source, bytes - kPointerSize, kPointerSize);
  FreeMemory(source, bytes - head, head + size, alignment);
}

}  // namespace

const MemorySource* CurrentMemorySource() {
  return current;
}

MemoryScope::MemoryScope(const MemorySource* source) : before_(current) {
  current = source;
}

MemoryScope::~MemoryScope() {
  current = before_;
}

void* AllocateMemory(const MemorySource* source, std::size_t size, std::size_t alignment) {
  if (source == nullptr) {
    if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return ::operator new(size);
    return ::operator new (size, std::align_val_t{alignment});
  }
  void* memory = source->allocate(source->user, size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  if (reinterpret_cast<std::uintptr_t>(memory) % alignment == 0) return memory;
  source->free(source->user, memory, size, alignment);
  throw std::bad_alloc();
}

void FreeMemory(const MemorySource* source, void* memory, std::size_t size, std::size_t alignment) {
  if (source != nullptr) {
    source->free(source->user, memory, size, alignment);
  } else if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) {
    ::operator delete(memory, size);
  } else {
    ::operator delete (memory, size, std::align_val_t{alignment});
  }
}

void* NewFromSource::operator new(std::size_t size) {
  return NewWithHead(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}

void* NewFromSource::operator new(std::size_t size, std::align_val_t alignment) {
  return NewWithHead(size, static_cast<std::size_t>(alignment));
}

void NewFromSource::operator delete(void* memory, std::size_t size) {
  DeleteWithHead(memory, size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}

void NewFromSource::operator delete(void* memory, std::size_t size, std::align_val_t alignment) {
  DeleteWithHead(memory, size, static_cast<std::size_t>(alignment));
}

}  // namespace limber
