// The threads of a context that has no job system of its host's: a loop over independent rounds.
#pragma once

#include "core/vector.h"

#include <atomic>
#include <cstdint>
#include <thread>

namespace limber::capi {

// Sleeping threads that wake for one loop at a time. After the constructor nothing allocates and no
// lock is taken.
class WorkerPool {
 public:
  using Task = void (*)(void* data, uint32_t index);

  static constexpr uint32_t kMostRounds = (1u << 20) - 1;

  // That many threads beside the caller's of Run; fewer where the system gives no more.
  explicit WorkerPool(unsigned num_workers);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  ~WorkerPool();

  // task(data, 0) to task(data, count - 1), each once, in any order, on the workers and on the
  // calling thread; returns when all are done. count <= kMostRounds. A second Run while one goes on
  // does its rounds on its own thread. The task must not throw.
  void Run(Task task, void* data, uint32_t count);

 private:
  // One word, so that a thread that comes late can never take a round of the next loop for one of
  // its own: the loop's number, its rounds, and the next to be taken.
  struct Loop {
    uint32_t number = 0, count = 0, next = 0;

    static Loop Unpack(uint64_t word);
    uint64_t Pack() const;
  };

  void Work();
  // Takes one round and does it; false where none is left.
  bool DoRound();

  std::atomic<uint64_t> loop_ = 0;
  std::atomic<uint32_t> done_ = 0;  // rounds of this loop
  std::atomic<uint32_t> wakes_ = 0;
  std::atomic<bool> running_ = false, stop_ = false;
  Task task_ = nullptr;  // written before loop_, read after a round of it is taken
  void* data_ = nullptr;
  Vector<std::thread> threads_;
};

}  // namespace limber::capi
