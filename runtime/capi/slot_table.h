// Objects behind the ids that a C caller holds: found without a lock, while others come and go.
#pragma once

#include "core/vector.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>

namespace limber::capi {

// An id is a slot and the generation of what is in it; generations begin at one, so that zero is
// never an id. Slots never move: a reader needs no lock.
struct SlotId {
  uint32_t index = 0, generation = 0;
};

template <class T>
class SlotTable {
 public:
  SlotTable() = default;
  SlotTable(const SlotTable&) = delete;
  SlotTable& operator=(const SlotTable&) = delete;

  ~SlotTable() {
    for (uint32_t index = 0; index < num_slots_; ++index)
      delete SlotAt(index)->object.load(std::memory_order_relaxed);
  }

  // False where the table is full. Throws std::bad_alloc, the table being as it was.
  bool Insert(std::unique_ptr<T> object, SlotId* id) {
    const std::lock_guard lock(mutex_);
    if (free_.empty() && !AddSlot()) return false;
    const uint32_t index = free_.back();
    free_.pop_back();
    Slot& slot = *SlotAt(index);
    slot.object.store(object.release(), std::memory_order_relaxed);
    const uint32_t generation = slot.next_generation;
    slot.generation.store(generation, std::memory_order_release);
    *id = {index, generation};
    return true;
  }

  // Null where the id is none (any more). The object lives until Remove.
  T* Find(SlotId id) const {
    const Slot* slot = SlotAt(id.index);
    if (slot == nullptr || id.generation == 0) return nullptr;
    if (slot->generation.load(std::memory_order_acquire) != id.generation) return nullptr;
    return slot->object.load(std::memory_order_relaxed);
  }

  // What was there, or null.
  std::unique_ptr<T> Remove(SlotId id) {
    const std::lock_guard lock(mutex_);
    if (Find(id) == nullptr) return nullptr;
    Slot& slot = *SlotAt(id.index);
    slot.generation.store(0, std::memory_order_release);
    slot.next_generation = id.generation == UINT32_MAX ? 1 : id.generation + 1;
    free_.push_back(id.index);  // there is room: AddSlot made it
    return std::unique_ptr<T>(slot.object.exchange(nullptr, std::memory_order_relaxed));
  }

 private:
  static constexpr uint32_t kChunk = 1024, kChunks = 1024;

  struct Slot {
    std::atomic<uint32_t> generation = 0;
    std::atomic<T*> object = nullptr;
    uint32_t next_generation = 1;
  };

  Slot* SlotAt(uint32_t index) const {
    if (index / kChunk >= kChunks) return nullptr;
    Slot* chunk = chunks_[index / kChunk].load(std::memory_order_acquire);
    return chunk == nullptr ? nullptr : chunk + index % kChunk;
  }

  bool AddSlot() {
    if (num_slots_ == kChunk * kChunks) return false;
    free_.reserve(num_slots_ + 1);
    std::atomic<Slot*>& chunk = chunks_[num_slots_ / kChunk];
    if (chunk.load(std::memory_order_relaxed) == nullptr) {
      owned_.emplace_back(kChunk);
      chunk.store(owned_.back().data(), std::memory_order_release);
    }
    free_.push_back(num_slots_++);
    return true;
  }

  std::mutex mutex_;  // of everything but Find
  std::array<std::atomic<Slot*>, kChunks> chunks_ = {};
  Vector<uint32_t> free_;
  Vector<Vector<Slot>> owned_;  // what chunks_ points to
  uint32_t num_slots_ = 0;
};

}  // namespace limber::capi
