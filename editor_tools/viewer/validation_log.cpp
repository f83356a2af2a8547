#include "viewer/validation_log.h"

#include "core/vector.h"

#include <algorithm>
#include <utility>

namespace limber::viewer {

int ValidationLog::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

Vector<std::string> ValidationLog::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

void ValidationLog::Add(std::string message) {
  const std::lock_guard lock(mutex_);
  ++count_;
  const bool known = std::find(messages_.begin(), messages_.end(), message) != messages_.end();
  if (!known && messages_.size() < 100) messages_.push_back(std::move(message));
}

void ValidationLog::Clear() {
  const std::lock_guard lock(mutex_);
  count_ = 0;
  messages_.clear();
}

}  // namespace limber::viewer
