#include "core/aligned_vector.h"
#include "core/vector.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace limber {
namespace {

// Counts what is out.
struct Counter {
  int live = 0;
  std::size_t last_alignment = 0;
  bool gives_unaligned = false;
  MemorySource source = {&Counter::Allocate, &Counter::Free, this};

  static void* Allocate(void* user, std::size_t size, std::size_t alignment) {
    auto* self = static_cast<Counter*>(user);
    ++self->live;
    self->last_alignment = alignment;
    auto* memory =
        static_cast<char*>(std::aligned_alloc(alignment, (size / alignment + 2) * alignment));
    return self->gives_unaligned ? memory + 1 : memory;
  }

  static void Free(void* user, void* memory, std::size_t /*size*/, std::size_t /*alignment*/) {
    auto* self = static_cast<Counter*>(user);
    --self->live;
    std::free(self->gives_unaligned ? static_cast<char*>(memory) - 1 : memory);
  }
};

struct Object : NewFromSource {
  double numbers[3] = {1, 2, 3};
};

struct alignas(128) WideObject : NewFromSource {
  double number = 1;
};

TEST(MemorySource, Scopes_NestAndEnd) {
  Counter outer, inner;
  EXPECT_EQ(CurrentMemorySource(), nullptr);
  {
    const MemoryScope a(&outer.source);
    {
      const MemoryScope b(&inner.source);
      EXPECT_EQ(CurrentMemorySource(), &inner.source);
      const MemoryScope heap(nullptr);
      EXPECT_EQ(CurrentMemorySource(), nullptr);
    }
    EXPECT_EQ(CurrentMemorySource(), &outer.source);
  }
  EXPECT_EQ(CurrentMemorySource(), nullptr);
}

TEST(MemorySource, Vectors_GoBackWhereTheyCameFrom) {
  Counter a, b;
  std::optional<Vector<int>> kept;
  {
    const MemoryScope scope(&a.source);
    kept.emplace(100, 7);
  }
  EXPECT_EQ(a.live, 1);
  {
    const MemoryScope scope(&b.source);
    kept->resize(10'000);  // whoever makes it grow
    EXPECT_EQ(b.live, 0);
    Vector<int> copy = *kept;  // a copy belongs to whoever makes it
    EXPECT_EQ(b.live, 1);
    *kept = std::move(copy);  // a move takes the memory along
    EXPECT_EQ(a.live, 0);
    EXPECT_EQ(b.live, 1);
    const Vector<int> moved = std::move(*kept);
    EXPECT_EQ(moved[50], 7);
  }
  EXPECT_EQ(b.live, 0);
}

TEST(MemorySource, AssignedCopies_StayInTheirOwn) {
  Counter a;
  Vector<int> on_the_heap(10, 1);
  {
    const MemoryScope scope(&a.source);
    const Vector<int> theirs(20, 2);
    on_the_heap = theirs;
    EXPECT_EQ(a.live, 1);
  }
  EXPECT_EQ(a.live, 0);
  EXPECT_EQ(on_the_heap, Vector<int>(20, 2));
}

TEST(MemorySource, Swap_TakesTheSourcesAlong) {
  Counter a;
  Vector<int> outside(3, 1);
  {
    std::optional<Vector<int>> inside;
    const MemoryScope scope(&a.source);
    inside.emplace(4, 2);
    inside->swap(outside);
    EXPECT_EQ(*inside, Vector<int>(3, 1));
  }
  EXPECT_EQ(a.live, 1);
  outside = Vector<int>();
  EXPECT_EQ(a.live, 0);
}

TEST(MemorySource, Objects_GoBackOutsideOfTheScope) {
  Counter a;
  std::unique_ptr<Object> object;
  std::unique_ptr<WideObject> wide;
  std::shared_ptr<Object> shared, adopted;
  {
    const MemoryScope scope(&a.source);
    object = std::make_unique<Object>();
    wide = std::make_unique<WideObject>();
    EXPECT_EQ(a.last_alignment, 128u);
    shared = MakeShared<Object>();
    EXPECT_EQ(a.live, 3);
    adopted = Share(new Object());
    EXPECT_EQ(a.live, 5);  // object and count
  }
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(wide.get()) % 128, 0u);
  object.reset();
  wide.reset();
  shared.reset();
  adopted.reset();
  EXPECT_EQ(a.live, 0);
  object = std::make_unique<Object>();
  EXPECT_EQ(a.live, 0);
  EXPECT_EQ(object->numbers[2], 3);
}

TEST(MemorySource, AlignedVectors_AreAlignedWhateverTheirSize) {
  Counter a;
  const MemoryScope scope(&a.source);
  for (const std::size_t size : {std::size_t{1}, std::size_t{1000}, std::size_t{3} << 20}) {
    const AlignedVector<float> numbers(size);
    EXPECT_EQ(a.last_alignment, 64u) << "no page larger than a cache line is asked of a host";
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % 64, 0u);
  }
  EXPECT_EQ(a.live, 0);
}

TEST(MemorySource, WhatIsNotAligned_IsRefusedAndGivenBack) {
  Counter a;
  a.gives_unaligned = true;
  const MemoryScope scope(&a.source);
  EXPECT_THROW(Vector<double>(10), std::bad_alloc);
  EXPECT_THROW((void)std::make_unique<WideObject>(), std::bad_alloc);
  EXPECT_EQ(a.live, 0);
}

TEST(MemorySource, Strings_Too) {
  Counter a;
  const MemoryScope scope(&a.source);
  String text("a text that is longer than what a string has room for in itself");
  EXPECT_EQ(a.live, 1);
  text = String();
  text.shrink_to_fit();
  EXPECT_EQ(a.live, 0);
}

}  // namespace
}  // namespace limber
