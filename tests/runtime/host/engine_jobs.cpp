#include "engine_jobs.h"

namespace engine {

Jobs::Jobs(int num_workers) {
  for (int i = 1; i < num_workers; ++i)
    workers_.emplace_back([this] { Work(); });
}

Jobs::~Jobs() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_)
    worker.join();
}

// One round; false: there is none left to begin.
bool Jobs::TakeRounds(bool is_caller) {
  uint32_t index = 0;
  {
    const std::lock_guard lock(mutex_);
    if (next_ == count_) return false;
    index = next_++;
  }
  round_(data_, index);
  if (!is_caller) ++num_stolen_;
  const std::lock_guard lock(mutex_);
  if (--num_open_ == 0) done_.notify_all();
  return true;
}

void Jobs::Run(void (*round)(void*, uint32_t), void* data, uint32_t count) {
  if (count == 0) return;
  {
    const std::lock_guard lock(mutex_);
    round_ = round;
    data_ = data;
    next_ = 0;
    count_ = num_open_ = count;
  }
  wake_.notify_all();
  while (TakeRounds(true)) {
  }
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return num_open_ == 0; });
}

void Jobs::Work() {
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || next_ != count_; });
      if (stop_) return;
    }
    while (TakeRounds(false)) {
    }
  }
}

}  // namespace engine
