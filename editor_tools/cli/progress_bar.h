// One line on the terminal that shows how far long work has come; nothing where stderr is a file.
#pragma once

#include "cli/console.h"

#include <chrono>
#include <string>

namespace limber::cli {

class ProgressBar {
 public:
  explicit ProgressBar(const Console& console);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // fraction in [0, 1]. Returns false when the user has asked to stop. May be called often: it
  // draws at most some ten times a second.
  bool Update(const char* stage, double fraction);
  // Removes the line, so that what follows starts on a clean one. The destructor does it, too.
  void Clear();

 private:
  bool visible_ = false;
  bool drawn_ = false;
  std::string last_stage_;
  std::chrono::steady_clock::time_point last_draw_;
};

}  // namespace limber::cli
