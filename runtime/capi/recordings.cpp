// limber.h: input that is recorded and replayed.
#include "capi/context.h"
#include "capi/instance_calls.h"
#include "drive/input_replay.h"

#include <cstring>

namespace limber::capi {
namespace {

constexpr uint32_t kReplayCookie = 0x4C4D4308;

// Ends the instance that a replay plays.
class Ending {
 public:
  Ending(LimberContext* context, SlotId id) : context_(context), id_(id) {}

  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;

  ~Ending() { context_->instances.Remove(id_); }

 private:
  LimberContext* context_;
  SlotId id_;
};

// What a caller wants to see of a replay.
struct Watcher {
  LimberReplayFunction on_frame;
  void* user;
};

CallStatus MakeReplayed(const PoseRoom& room, RigEntry* entry, LimberContext* context, SlotId* id) {
  LimberInstanceDef def = limberDefaultInstanceDef();
  def.max_grabs = room.grabs;
  def.max_rotations = room.rotations;
  def.guaranteed = room.guaranteed ? 1 : 0;
  std::unique_ptr<Instance> made;
  LIMBER_RETURN_IF_FAILED(MakeInstance(def, entry, &made));
  if (context->instances.Insert(std::move(made), id)) return {};
  return {LIMBER_ERROR_LIMIT_EXCEEDED, "a million instances are there already"};
}

CallStatus Replay(LimberContext* context, RigEntry* entry, std::span<const uint8_t> bytes,
                  const Watcher& watcher, LimberReplayReport* report) {
  auto replay = InputReplay::Create(*entry->rig, bytes);
  if (!replay.ok()) return replay.status();
  SlotId id;
  LIMBER_RETURN_IF_FAILED(MakeReplayed(replay->room(), entry, context, &id));
  const Ending ending(context, id);
  Instance* instance = context->instances.Find(id);
  while (true) {
    bool same = false;
    const Result<bool> more = ReplayFrame(&*replay, &instance->state, &same);
    if (!more.ok()) {
      return Status(more.status().code(),
                    "frame " + std::to_string(report->num_frames) + ": " + more.status().message());
    }
    if (!*more) return {};
    if (!same && report->num_different++ == 0) report->first_different = report->num_frames;
    const uint32_t frame = report->num_frames++;
    if (watcher.on_frame == nullptr) continue;
    if (watcher.on_frame(watcher.user, {id.index, id.generation}, frame) != 0) return {};
  }
}

}  // namespace
}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberResult limberGetRecording(LimberContext* context, LimberInstanceId instance, void* bytes,
                                size_t size, size_t* needed) {
  return CallOn(context, "limberGetRecording", instance, [&](Instance* of) -> CallStatus {
    if (needed == nullptr) return NullArgument("needed");
    if (of->recorder == nullptr) {
      return {LIMBER_ERROR_UNSUPPORTED,
              "nothing is recorded (LimberInstanceDef::record), or it ended: with another rig, or "
              "for want of memory"};
    }
    const std::span<const uint8_t> from = of->recorder->bytes();
    *needed = from.size();
    if (bytes != nullptr) std::memcpy(bytes, from.data(), std::min(size, from.size()));
    return {};
  });
}

LimberReplayDef limberDefaultReplayDef(void) {
  LimberReplayDef def = {};
  def.cookie = kReplayCookie;
  def.struct_size = sizeof(def);
  return def;
}

LimberResult limberReplay(LimberContext* context, LimberRigId rig, const LimberReplayDef* def,
                          LimberReplayReport* report) {
  return CallOn(context, "limberReplay", rig, [&](RigEntry* entry) -> CallStatus {
    if (def == nullptr) return NullArgument("def");
    LimberReplayDef full = limberDefaultReplayDef();
    LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberReplayDef", &full));
    if (full.bytes == nullptr) return NullArgument("def: bytes");
    LimberReplayReport counted = {};
    const std::span from(static_cast<const uint8_t*>(full.bytes), full.num_bytes);
    CallStatus status = Replay(context, entry, from, {full.on_frame, full.user}, &counted);
    if (status.ok() && report != nullptr) *report = counted;
    return status;
  });
}

}  // extern "C"
