// limber.h: a file's own animations as input.
#include "capi/inputs.h"

#include <cmath>

namespace limber::capi {
namespace {

constexpr uint32_t kClipCookie = 0x4C4D4307;

CallStatus CheckClip(const HandleClips& clips, int32_t clip) {
  if (clip >= 0 && clip < clips.num_clips()) return {};
  return {LIMBER_ERROR_INVALID_ARGUMENT,
          "clip " + std::to_string(clip) + ": there are " + std::to_string(clips.num_clips())};
}

std::string NamesOf(const HandleClips& clips) {
  std::string names;
  for (int clip = 0; clip < clips.num_clips(); ++clip)
    names += std::string(clip == 0 ? "" : ", ").append(clips.name(clip));
  return names.empty() ? "none that moves a handle" : names;
}

double TimeWithin(const LimberClipDef& def, double duration) {
  if (def.loops == 0 || duration <= 0) return def.time;
  const double time = std::fmod(def.time, duration);
  return time < 0 ? time + duration : time;
}

float Mix(float a, float b, float t) {
  return a + t * (b - a);
}

// Along the shorter arc, at less than constant speed: weights move slowly.
Quaternion Mix(const Quaternion& a, const Quaternion& b, float t) {
  const float same = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0 ? -1.0f : 1.0f;
  const Quaternion q = {Mix(a.x, same * b.x, t), Mix(a.y, same * b.y, t), Mix(a.z, same * b.z, t),
                        Mix(a.w, same * b.w, t)};
  const float length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(length > 0)) return b;
  return {q.x / length, q.y / length, q.z / length, q.w / length};
}

CallStatus ApplyTo(const LimberClipDef& def, const ClipHandle& of, const HandlePlace& place,
                   Instance* instance) {
  const int handle = of.handle;
  const Vec3 from = instance->state.target(handle);
  const Vec3 to = {Mix(from.x, place.position.x, def.weight),
                   Mix(from.y, place.position.y, def.weight),
                   Mix(from.z, place.position.z, def.weight)};
  LIMBER_RETURN_IF_FAILED(Ask(TargetEvent(handle, to), instance));
  if (!of.is_turned || def.rotations == 0) return {};
  const HandleWishes& wishes = instance->wishes[static_cast<size_t>(handle)];
  const Quaternion turned = wishes.is_turned ? wishes.rotation : Quaternion();
  return Ask(RotationEvent(handle, Mix(turned, place.rotation, def.weight), def.rotation_stiffness),
             instance);
}

CallStatus Apply(const LimberClipDef& def, Instance* instance) {
  const HandleClips& clips = *instance->clips;
  LIMBER_RETURN_IF_FAILED(CheckClip(clips, def.clip));
  if (!std::isfinite(def.time)) return {LIMBER_ERROR_INVALID_ARGUMENT, "time: it is not finite"};
  if (!(def.weight >= 0 && def.weight <= 1))
    return {LIMBER_ERROR_INVALID_ARGUMENT, "weight: from 0 to 1"};
  const double time = TimeWithin(def, clips.duration(def.clip));
  const HandleClips::Moment moment = clips.MomentOf(def.clip, time);
  for (const ClipHandle& handle : clips.handles(def.clip)) {
    if (!instance->state.is_pinned(handle.handle)) continue;
    CallStatus applied = ApplyTo(def, handle, clips.Sample(moment, handle), instance);
    if (applied.ok()) continue;
    const auto index = static_cast<size_t>(handle.handle);
    const String& name = instance->rig->tables().handles[index].name;
    return {applied.result, "clip " + std::string(clips.name(def.clip)) + ": handle " +
                                std::string(name) + ": " + applied.message};
  }
  return {};
}

}  // namespace
}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberResult limberGetNumClips(LimberContext* context, LimberRigId rig, int32_t* count) {
  return CallOn(context, "limberGetNumClips", rig, [&](const RigEntry* entry) -> CallStatus {
    if (count == nullptr) return NullArgument("count");
    *count = entry->clips->num_clips();
    return {};
  });
}

LimberResult limberGetClipInfo(LimberContext* context, LimberRigId rig, int32_t clip,
                               LimberClipInfo* info) {
  return CallOn(context, "limberGetClipInfo", rig, [&](const RigEntry* entry) -> CallStatus {
    if (info == nullptr) return NullArgument("info");
    LIMBER_RETURN_IF_FAILED(CheckClip(*entry->clips, clip));
    *info = {entry->clips->name(clip).c_str(), entry->clips->duration(clip),
             static_cast<int32_t>(entry->clips->handles(clip).size())};
    return {};
  });
}

LimberResult limberFindClip(LimberContext* context, LimberRigId rig, const char* name,
                            int32_t* clip) {
  return CallOn(context, "limberFindClip", rig, [&](const RigEntry* entry) -> CallStatus {
    if (name == nullptr) return NullArgument("name");
    if (clip == nullptr) return NullArgument("clip");
    const int found = entry->clips->Find(name);
    if (found < 0) {
      return {LIMBER_ERROR_NOT_FOUND,
              "no clip '" + std::string(name) + "'; there are " + NamesOf(*entry->clips)};
    }
    *clip = found;
    return {};
  });
}

LimberClipDef limberDefaultClipDef(void) {
  LimberClipDef def = {};
  def.cookie = kClipCookie;
  def.struct_size = sizeof(def);
  def.loops = 1;
  def.weight = 1;
  def.rotations = 1;
  def.rotation_stiffness = LIMBER_HELD_EXACTLY;
  return def;
}

LimberResult limberApplyClip(LimberContext* context, LimberInstanceId instance,
                             const LimberClipDef* def) {
  return CallOn(context, "limberApplyClip", instance, [&](Instance* of) -> CallStatus {
    if (def == nullptr) return NullArgument("def");
    LimberClipDef full = limberDefaultClipDef();
    LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberClipDef", &full));
    return Apply(full, of);
  });
}

}  // extern "C"
