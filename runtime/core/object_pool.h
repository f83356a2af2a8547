// Objects that whoever needs one at the moment takes, and gives back.
#pragma once

#include <array>
#include <atomic>
#include <memory>

namespace limber {

// Any number of threads; no lock, and no allocation of its own.
template <class T>
class ObjectPool {
 public:
  ObjectPool() = default;
  ObjectPool(const ObjectPool&) = delete;
  ObjectPool& operator=(const ObjectPool&) = delete;

  ~ObjectPool() {
    for (std::atomic<T*>& slot : slots_)
      delete slot.load(std::memory_order_acquire);
  }

  // One that was given back, or null.
  std::unique_ptr<T> Take() {
    for (std::atomic<T*>& slot : slots_) {
      if (slot.load(std::memory_order_relaxed) == nullptr) continue;
      if (T* found = slot.exchange(nullptr, std::memory_order_acquire))
        return std::unique_ptr<T>(found);
    }
    return nullptr;
  }

  // Ends the object where more than kMost are idle.
  void Give(std::unique_ptr<T> object) {
    for (std::atomic<T*>& slot : slots_) {
      T* none = nullptr;
      if (slot.compare_exchange_strong(none, object.get(), std::memory_order_release,
                                       std::memory_order_relaxed)) {
        (void)object.release();
        return;
      }
    }
  }

  static constexpr size_t kMost = 64;

 private:
  std::array<std::atomic<T*>, kMost> slots_ = {};
};

}  // namespace limber
