#include "capi/worker_pool.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <numeric>

namespace limber::capi {
namespace {

struct Counts {
  explicit Counts(size_t size) : of(size) {}

  Vector<std::atomic<int>> of;
};

void Count(void* data, uint32_t index) {
  ++static_cast<Counts*>(data)->of[index];
}

TEST(WorkerPool, EachRound_IsDoneOnce) {
  for (const unsigned workers : {0U, 1U, 3U, 7U}) {
    WorkerPool pool(workers);
    for (const uint32_t size : {0U, 1U, 2U, 7U, 1000U}) {
      Counts counts(size);
      for (int loop = 1; loop <= 200; ++loop) {
        pool.Run(Count, &counts, size);
        for (const std::atomic<int>& count : counts.of)
          ASSERT_EQ(count.load(), loop);
      }
    }
  }
}

// Loops of several callers at once, each complete when its Run returns; one has the workers.
TEST(WorkerPool, CallersAtOnce_AllComplete) {
  WorkerPool pool(3);
  const auto call = [&pool] {
    Counts counts(50);
    for (int loop = 1; loop <= 500; ++loop) {
      pool.Run(Count, &counts, 50);
      for (const std::atomic<int>& count : counts.of)
        ASSERT_EQ(count.load(), loop);
    }
  };
  std::thread a(call), b(call);
  call();
  a.join();
  b.join();
}

// A loop within a round must not wait for itself.
TEST(WorkerPool, LoopWithinALoop_IsDoneByItsThread) {
  struct Nested {
    WorkerPool pool{2};
    Counts inner{10};
  } nested;

  nested.pool.Run(
      [](void* data, uint32_t) {
        auto* nest = static_cast<Nested*>(data);
        nest->pool.Run(Count, &nest->inner, 10);
      },
      &nested, 20);
  for (const std::atomic<int>& count : nested.inner.of)
    EXPECT_EQ(count.load(), 20);
}

TEST(WorkerPool, ThatNeverRan_Ends) {
  const WorkerPool pool(4);
}

}  // namespace
}  // namespace limber::capi
