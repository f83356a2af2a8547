// Alternations that many characters of one rig use in turn. An alternation is mostly scratch
// memory; what a character has to keep is a tenth of it (Alternation::Memory). So a crowd takes a
// tenth of the memory, and the scratch of each thread stays in its caches.
#pragma once

#include "solve/alternation.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"

#include <array>
#include <atomic>
#include <memory>

namespace limber {

// Those that nobody uses at the moment. Any number of threads; no lock.
template <int K>
class AlternationPool {
 public:
  AlternationPool() = default;
  AlternationPool(const AlternationPool&) = delete;
  AlternationPool& operator=(const AlternationPool&) = delete;

  ~AlternationPool() {
    for (std::atomic<Alternation<K>*>& slot : slots_)
      delete slot.load(std::memory_order_acquire);
  }

  // One that was given back, or null.
  std::unique_ptr<Alternation<K>> Take() {
    for (std::atomic<Alternation<K>*>& slot : slots_) {
      if (slot.load(std::memory_order_relaxed) == nullptr) continue;
      if (Alternation<K>* found = slot.exchange(nullptr, std::memory_order_acquire))
        return std::unique_ptr<Alternation<K>>(found);
    }
    return nullptr;
  }

  void Give(std::unique_ptr<Alternation<K>> alternation) {
    for (std::atomic<Alternation<K>*>& slot : slots_) {
      Alternation<K>* none = nullptr;
      if (slot.compare_exchange_strong(none, alternation.get(), std::memory_order_release,
                                       std::memory_order_relaxed)) {
        (void)alternation.release();
        return;
      }
    }
  }

 private:
  std::array<std::atomic<Alternation<K>*>, 64> slots_ = {};  // more threads: the rest is made anew
};

class PoseWorkspaces {
 public:
  // For states of that model with at most that room, the guaranteed mode apart.
  PoseWorkspaces(std::shared_ptr<const PoseModel> model, PoseRoom most);

  const std::shared_ptr<const PoseModel>& model() const { return model_; }

  bool HasRoomFor(const PoseRoom& room) const {
    return room.grabs <= most_.grabs && room.rotations <= most_.rotations && !room.guaranteed;
  }

  // Throws std::bad_alloc where one has to be made, which is as often as there are more at once
  // than ever before.
  template <int K>
  std::unique_ptr<Alternation<K>> Take();

  template <int K>
  void Give(std::unique_ptr<Alternation<K>> alternation);

 private:
  template <int K>
  AlternationPool<K>& Pool();

  std::shared_ptr<const PoseModel> model_;
  PoseRoom most_;
  AlternationPool<2> flat_;
  AlternationPool<3> solid_;
};

}  // namespace limber
