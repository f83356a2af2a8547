#include "viewer/play_title.h"

#include <cstdio>
#include <utility>

namespace limber::viewer {

PlayTitle::PlayTitle(std::string character)
    : character_(std::move(character)),
      text_(character_ + " - limber") {}

void PlayTitle::AddSolve(double ms) {
  solve_.sum += ms;
  ++solve_.count;
}

void PlayTitle::AddFrame(const StageTimes& times) {
  ++frames_;
  if (times.draw_ms <= 0) return;  // the first frame, or a device without a clock
  skin_.sum += times.skin_ms;
  draw_.sum += times.draw_ms;
  ++skin_.count;
  ++draw_.count;
}

void PlayTitle::Append(const char* stage, const Mean& mean, std::string* list) const {
  if (mean.count == 0) return;
  char text[64];
  std::snprintf(text, sizeof(text), "%s%s %.2f ms", list->empty() ? "" : ", ", stage,
                mean.sum / mean.count);
  *list += text;
}

bool PlayTitle::Update() {
  constexpr double kSeconds = 0.5;
  const Clock::time_point now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - since_).count();
  if (elapsed < kSeconds) return false;
  std::string list;
  Append("solve", solve_, &list);
  Append("skin", skin_, &list);
  Append("draw", draw_, &list);
  const int frames = std::exchange(frames_, 0);
  solve_ = skin_ = draw_ = Mean();
  since_ = now;
  if (list.empty()) return false;  // nothing moved: the last numbers stay
  char rate[48];
  std::snprintf(rate, sizeof(rate), ", %.0f frames a second", frames / elapsed);
  text_ = character_ + " - " + list + rate + " - limber";
  return true;
}

}  // namespace limber::viewer
