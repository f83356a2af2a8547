// Writes down what is asked of a character, so that it can be asked again: of a test, of whoever
// reads a bug report. The format, little-endian: "LMBREC" and two digits of version; rig hash (8
// bytes); grabs, rotations (4 each), guaranteed (1); then events: the kind (1) and what it needs.
// Options stand where they change, so that a frame of two targets takes some 50 bytes.
#pragma once

#include "core/memory_source.h"
#include "core/vector.h"
#include "drive/input_events.h"

#include <cstdint>
#include <span>

namespace limber {

inline constexpr char kRecordingMagic[9] = "LMBREC01";

class InputRecorder : public NewFromSource {
 public:
  explicit InputRecorder(const RecordingHead& head);

  // Throws std::bad_alloc, the recording being as it was.
  void Add(const InputEvent& event);

  std::span<const uint8_t> bytes() const { return bytes_; }

 private:
  Vector<uint8_t> bytes_;
  PoseOptions options_;  // that were written last
  bool has_options_ = false;
};

}  // namespace limber
