#include "threads/parallel_for.h"

#include "core/vector.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

namespace limber::threads {
namespace {

TEST(ParallelFor, EveryRoundOnce) {
  for (const int count : {0, 1, 2, 100}) {
    for (const int threads : {0, 1, 3, 200}) {
      Vector<std::atomic<int>> rounds(static_cast<size_t>(count));
      ParallelFor(count, threads, [&](int i) { ++rounds[static_cast<size_t>(i)]; });
      for (const std::atomic<int>& times : rounds)
        EXPECT_EQ(times, 1) << count << " rounds on " << threads;
    }
  }
}

TEST(ParallelFor, AnException_ComesOutAndEndsTheLoop) {
  for (const int threads : {1, 4}) {
    std::atomic<int> rounds = 0;
    const auto run = [&] {
      ParallelFor(1000000, threads, [&](int i) {
        if (i == 10) throw std::runtime_error("ten");
        ++rounds;
      });
    };
    EXPECT_THROW(run(), std::runtime_error);
    EXPECT_LT(rounds, 1000000);
  }
}

}  // namespace
}  // namespace limber::threads
