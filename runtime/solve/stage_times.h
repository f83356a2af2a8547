// Where the time of a solve goes, measured only on request: results never depend on it.
#pragma once

#include <chrono>

namespace limber {

// Seconds, summed over the alternations of a call.
struct StageTimes {
  double rotations = 0;   // fits K^ and their rotations (eq. 22, 23), products for the next ones
  double nearness = 0;    // the models of D (eq. 10); the few roots taken exactly count as blend
  double blend = 0;       // the convex step (eq. 20)
  double transforms = 0;  // skinning matrices out
};

// Gives the time since the last lap to a stage; reads no clock where times is null.
class StageWatch {
 public:
  explicit StageWatch(StageTimes* times) : times_(times) {
    if (times_ != nullptr) last_ = Clock::now();
  }

  void Lap(double StageTimes::*stage) {
    if (times_ == nullptr) return;
    const Clock::time_point now = Clock::now();
    times_->*stage += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  StageTimes* times_;
  Clock::time_point last_;
};

}  // namespace limber
