// The engine's job system: workers that take rounds of a loop, the caller among them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace engine {

class Jobs {
 public:
  explicit Jobs(int num_workers);
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;
  ~Jobs();

  // round(data, 0) to round(data, count - 1); returns when all are done.
  void Run(void (*round)(void* data, uint32_t index), void* data, uint32_t count);

  // Rounds that others than the caller did.
  int num_stolen() const { return num_stolen_; }

 private:
  void Work();
  bool TakeRounds(bool is_caller);

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  void (*round_)(void*, uint32_t) = nullptr;
  void* data_ = nullptr;
  uint32_t next_ = 0, count_ = 0, num_open_ = 0;
  bool stop_ = false;
  std::atomic<int> num_stolen_ = 0;
  std::vector<std::thread> workers_;
};

}  // namespace engine
