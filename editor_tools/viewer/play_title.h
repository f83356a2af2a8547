// The window's title: what a frame costs, renewed twice a second.
#pragma once

#include "viewer/renderer.h"

#include <chrono>
#include <string>

namespace limber::viewer {

class PlayTitle {
 public:
  explicit PlayTitle(std::string character);

  void AddSolve(double ms);  // one step of the solver
  void AddFrame(const StageTimes& times);
  // True when there is a new text.
  bool Update();

  // "horse - solve 0.21 ms, skin 1.10 ms, draw 6.30 ms, 60 frames a second - limber": means since
  // the last text; a stage that did not run is left out, and so are frames while nothing moved.
  const std::string& text() const { return text_; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Mean {
    double sum = 0;
    int count = 0;
  };

  void Append(const char* stage, const Mean& mean, std::string* list) const;

  std::string character_, text_;
  Mean solve_, skin_, draw_;
  int frames_ = 0;
  Clock::time_point since_ = Clock::now();
};

}  // namespace limber::viewer
