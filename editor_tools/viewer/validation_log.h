// Counts and keeps what the validation layers say, so that tests can fail on any message.
#pragma once

#include "core/vector.h"

#include <mutex>
#include <string>

namespace limber::viewer {

class ValidationLog {
 public:
  // Warnings and errors so far. Any thread.
  int count() const;
  // Their texts, the first hundred; each once.
  Vector<std::string> messages() const;
  void Add(std::string message);
  void Clear();

 private:
  mutable std::mutex mutex_;
  int count_ = 0;
  Vector<std::string> messages_;
};

}  // namespace limber::viewer
