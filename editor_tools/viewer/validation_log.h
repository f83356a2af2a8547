// Counts and keeps what the validation layers say, so that tests can fail on any message.
#pragma once

#include <mutex>
#include <string>
#include <vector>

namespace limber::viewer {

class ValidationLog {
 public:
  // Warnings and errors so far. Any thread.
  int count() const;
  // Their texts, the first hundred; each once.
  std::vector<std::string> messages() const;
  void Add(std::string message);
  void Clear();

 private:
  mutable std::mutex mutex_;
  int count_ = 0;
  std::vector<std::string> messages_;
};

}  // namespace limber::viewer
