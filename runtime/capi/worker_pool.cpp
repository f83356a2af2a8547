#include "capi/worker_pool.h"

#include <system_error>

namespace limber::capi {
namespace {

constexpr unsigned kRoundBits = 20;

}  // namespace

WorkerPool::Loop WorkerPool::Loop::Unpack(uint64_t word) {
  return {static_cast<uint32_t>(word >> (2 * kRoundBits)),
          static_cast<uint32_t>(word >> kRoundBits) & kMostRounds,
          static_cast<uint32_t>(word) & kMostRounds};
}

uint64_t WorkerPool::Loop::Pack() const {
  return uint64_t{number} << (2 * kRoundBits) | uint64_t{count} << kRoundBits | next;
}

WorkerPool::WorkerPool(unsigned num_workers) {
  threads_.reserve(num_workers);
  try {
    for (unsigned i = 0; i < num_workers; ++i)
      threads_.emplace_back([this] { Work(); });
  } catch (const std::system_error&) {  // then with those that there are
  }
}

WorkerPool::~WorkerPool() {
  stop_.store(true, std::memory_order_release);
  wakes_.fetch_add(1, std::memory_order_release);
  wakes_.notify_all();
  for (std::thread& thread : threads_)
    thread.join();
}

bool WorkerPool::DoRound() {
  uint64_t word = loop_.load(std::memory_order_acquire);
  for (;;) {
    Loop loop = Loop::Unpack(word);
    if (loop.next >= loop.count) return false;
    ++loop.next;
    if (loop_.compare_exchange_weak(word, loop.Pack(), std::memory_order_acq_rel,
                                    std::memory_order_acquire)) {
      // The loop cannot end before this round has: task_ and data_ stay.
      task_(data_, loop.next - 1);
      if (done_.fetch_add(1, std::memory_order_acq_rel) + 1 == loop.count) done_.notify_all();
      return true;
    }
  }
}

void WorkerPool::Work() {
  uint32_t seen = wakes_.load(std::memory_order_acquire);
  for (;;) {
    while (DoRound()) {
    }
    if (stop_.load(std::memory_order_acquire)) return;
    wakes_.wait(seen, std::memory_order_acquire);
    seen = wakes_.load(std::memory_order_acquire);
  }
}

void WorkerPool::Run(Task task, void* data, uint32_t count) {
  if (count == 0) return;
  const bool alone = threads_.empty() || count == 1;
  if (alone || running_.exchange(true, std::memory_order_acquire)) {
    for (uint32_t i = 0; i < count; ++i)
      task(data, i);
    return;
  }
  task_ = task;
  data_ = data;
  done_.store(0, std::memory_order_relaxed);
  const Loop last = Loop::Unpack(loop_.load(std::memory_order_relaxed));
  loop_.store(Loop{(last.number + 1) & 0xffffff, count, 0}.Pack(), std::memory_order_release);
  wakes_.fetch_add(1, std::memory_order_release);
  wakes_.notify_all();
  while (DoRound()) {
  }
  for (uint32_t done = done_.load(std::memory_order_acquire); done < count;
       done = done_.load(std::memory_order_acquire))
    done_.wait(done, std::memory_order_acquire);
  running_.store(false, std::memory_order_release);
}

}  // namespace limber::capi
