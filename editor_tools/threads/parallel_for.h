// A loop whose rounds do not depend on each other, on several threads.
#pragma once

#include "core/vector.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace limber::threads {

// body(0) to body(count - 1), in any order, on num_threads threads (<= 0: one per core), of which
// the caller's is one. The first exception of a body ends the loop and is thrown here.
template <class Body>
void ParallelFor(int count, int num_threads, const Body& body) {
  if (num_threads <= 0)
    num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<int> next = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (int i = next++; i < count; i = next++)
        body(i);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    Vector<std::jthread> others;  // joined whatever happens, a thread that cannot start too
    for (int i = 1; i < std::min(num_threads, count); ++i)
      others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace limber::threads
