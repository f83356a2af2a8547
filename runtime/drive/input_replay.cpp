#include "drive/input_replay.h"

#include "drive/event_codec.h"
#include "drive/input_recorder.h"
#include "drive/rig_hash.h"

#include <algorithm>

namespace limber {
namespace {

// Hands bytes out until there are too few; visited by VisitEvent.
struct Reader {
  std::span<const uint8_t> bytes;
  size_t* at;
  bool* ok;

  template <class T>
  void operator()(T& value) const {
    if (!*ok || bytes.size() - *at < sizeof(T)) {
      *ok = false;
      return;
    }
    uint8_t raw[sizeof(T)];
    std::memcpy(raw, bytes.data() + *at, sizeof(T));
    T given;
    std::memcpy(&given, raw, sizeof(T));
    ToLittleEndian(given, raw);  // which is its own inverse
    std::memcpy(&value, raw, sizeof(T));
    *at += sizeof(T);
  }
};

bool IsKind(InputKind kind) {
  return kind >= InputKind::kTarget && kind <= InputKind::kSolve;
}

}  // namespace

Status InputReplay::Malformed(const char* what) const {
  return Error(StatusCode::kMalformed, "recording: byte %zu: %s", at_, what);
}

Status InputReplay::ReadHead() {
  constexpr size_t kMagic = 6, kSize = 8;
  if (bytes_.size() < kSize || std::memcmp(bytes_.data(), kRecordingMagic, kMagic) != 0)
    return Malformed("this is not a recording of Limber's");
  if (std::memcmp(bytes_.data(), kRecordingMagic, kSize) != 0) {
    return Error(StatusCode::kVersionMismatch,
                 "recording: made by a newer Limber; update this one to replay it");
  }
  at_ = kSize;
  bool ok = true;
  VisitHead(&head_, Reader{bytes_, &at_, &ok});
  return ok ? Status() : Malformed("the recording ends within its head");
}

Result<InputReplay> InputReplay::Create(const Rig& rig, std::span<const uint8_t> bytes) {
  InputReplay replay(bytes);
  LIMBER_RETURN_IF_ERROR(replay.ReadHead());
  if (replay.head_.rig_hash != HashRig(rig)) {
    return Error(StatusCode::kMeshMismatch,
                 "recording: made with another bake of the character; replay it with that one");
  }
  return replay;
}

Result<bool> InputReplay::Next(InputEvent* event) {
  do {
    if (at_ == bytes_.size()) return false;
    event->kind = static_cast<InputKind>(bytes_[at_]);
    if (!IsKind(event->kind)) return Malformed("no such event");
    bool ok = true;
    VisitEvent(event, Reader{bytes_, &at_, &ok});
    if (!ok) return Malformed("the recording ends within an event");
    if (event->kind == InputKind::kOptions) options_ = event->options;
  } while (event->kind == InputKind::kOptions);
  event->options = options_;
  if (event->kind == InputKind::kSolve) event->options.iterations = event->iterations;
  if (event->kind == InputKind::kGrabTarget || event->kind == InputKind::kRelease) {
    const auto known = std::find_if(grabs_.rbegin(), grabs_.rend(), [event](const auto& grab) {
      return grab.first == event->index;
    });
    if (known != grabs_.rend()) event->index = known->second;
  }
  return true;
}

Result<bool> ReplayFrame(InputReplay* replay, PoseState* state, bool* same) {
  InputEvent event;
  while (true) {
    Result<bool> more = replay->Next(&event);
    if (!more.ok() || !*more) return more;
    int grab = 0;
    LIMBER_RETURN_IF_ERROR(ApplyInput(event, state, &grab));
    if (event.kind == InputKind::kGrab) replay->MapGrab(event.index, grab);
    if (event.kind != InputKind::kSolve) continue;
    *same = HashPose(state->transforms()) == event.pose_hash;
    return true;
  }
}

}  // namespace limber
