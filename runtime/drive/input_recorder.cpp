#include "drive/input_recorder.h"

#include "core/vector.h"
#include "drive/event_codec.h"

namespace limber {
namespace {

// Collects bytes; visited by VisitEvent.
struct Writer {
  Vector<uint8_t>* bytes;

  template <class T>
  void operator()(const T& value) const {
    uint8_t raw[sizeof(T)];
    ToLittleEndian(value, raw);
    bytes->insert(bytes->end(), raw, raw + sizeof(T));
  }
};

}  // namespace

InputRecorder::InputRecorder(const RecordingHead& head) {
  bytes_.assign(kRecordingMagic, kRecordingMagic + 8);
  RecordingHead writable = head;
  VisitHead(&writable, Writer{&bytes_});
}

void InputRecorder::Add(const InputEvent& event) {
  const size_t before = bytes_.size();
  try {
    InputEvent writable = event;
    const bool changes =
        event.kind == InputKind::kSolve && (!has_options_ || !SameOptions(options_, event.options));
    if (changes) {
      writable.kind = InputKind::kOptions;
      VisitEvent(&writable, Writer{&bytes_});
      writable.kind = InputKind::kSolve;
    }
    VisitEvent(&writable, Writer{&bytes_});
    if (!changes) return;
    options_ = event.options;
    has_options_ = true;
  } catch (...) {
    bytes_.resize(before);
    throw;
  }
}

}  // namespace limber
