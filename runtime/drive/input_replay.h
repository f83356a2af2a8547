// Reads a recording, and asks it again of a character. The bytes may come from anywhere: all is
// checked.
#pragma once

#include "core/vector.h"
#include "drive/input_events.h"

#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace limber {

class InputReplay {
 public:
  // `bytes` must outlive the replay. Errors: kMalformed (not a recording), kVersionMismatch (of a
  // newer Limber), kMeshMismatch (of another bake).
  static Result<InputReplay> Create(const Rig& rig, std::span<const uint8_t> bytes);

  const PoseRoom& room() const { return head_.room; }

  // The next event, its grab by the number that it has now; false: there is none. Errors:
  // kMalformed, with the byte.
  Result<bool> Next(InputEvent* event);

  // Tells which number a recorded grab has got this time.
  void MapGrab(int recorded, int now) { grabs_.emplace_back(recorded, now); }

  size_t position() const { return at_; }

 private:
  explicit InputReplay(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  Status ReadHead();
  Status Malformed(const char* what) const;

  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  RecordingHead head_;
  PoseOptions options_;
  Vector<std::pair<int, int>> grabs_;
};

// Asks all up to the next solve, and that; false: the recording ends before one. *same: whether
// the pose has the recorded bits, which it has on machines of one kind. Errors: those of Next and
// of PoseState's calls.
Result<bool> ReplayFrame(InputReplay* replay, PoseState* state, bool* same);

}  // namespace limber
