#include "cli/progress_bar.h"

#include "cli/interrupt.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace limber::cli {

ProgressBar::ProgressBar(const Console& console)
    : visible_(!console.json && !console.quiet && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  Clear();
}

bool ProgressBar::Update(const char* stage, double fraction) {
  const bool go_on = !InterruptRequested();
  if (!visible_) return go_on;
  const auto now = std::chrono::steady_clock::now();
  const bool same_stage = last_stage_ == stage;
  if (drawn_ && same_stage && now - last_draw_ < std::chrono::milliseconds(80)) return go_on;
  constexpr int kWidth = 32;
  fraction = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(fraction * kWidth);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K[%s] %3d %%  %.40s", bar.c_str(), static_cast<int>(100 * fraction),
               stage);
  std::fflush(stderr);
  drawn_ = true;
  last_stage_ = stage;
  last_draw_ = now;
  return go_on;
}

void ProgressBar::Clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace limber::cli
