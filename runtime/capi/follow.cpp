// limber.h: a spring between a moving input and a handle.
#include "capi/inputs.h"
#include "drive/reach.h"

#include <cmath>

namespace limber::capi {
namespace {

constexpr uint32_t kFollowCookie = 0x4C4D4306;
constexpr double kMostFrequency = 1e4, kMostDamping = 1e4, kMostTimeStep = 1e4;

CallStatus CheckNumber(const char* name, double value, double most, bool may_be_zero) {
  if (value >= 0 && value <= most && (may_be_zero || value > 0)) return {};
  char text[160];
  std::snprintf(text, sizeof text, "%s: %g; from 0%s to %g", name, value,
                may_be_zero ? "" : " (not 0 itself)", most);
  return {LIMBER_ERROR_INVALID_ARGUMENT, text};
}

CallStatus CheckFollow(const LimberFollowDef& def, const float* goal) {
  LIMBER_RETURN_IF_FAILED(CheckNumber("frequency", def.frequency, kMostFrequency, false));
  LIMBER_RETURN_IF_FAILED(CheckNumber("damping", def.damping, kMostDamping, true));
  LIMBER_RETURN_IF_FAILED(CheckNumber("time_step", def.time_step, kMostTimeStep, true));
  LIMBER_RETURN_IF_FAILED(CheckNumber("reach", def.reach, HUGE_VAL, true));
  if (goal == nullptr) return NullArgument("goal");
  if (std::isfinite(goal[0]) && std::isfinite(goal[1]) && std::isfinite(goal[2])) return {};
  return {LIMBER_ERROR_INVALID_ARGUMENT, "goal: it is not finite"};
}

CallStatus Follow(const LimberFollowDef& def, int32_t handle, Vec3 goal, Instance* instance) {
  LIMBER_RETURN_IF_FAILED(CheckHandle(*instance->rig, handle));
  SpringFollower follower = instance->followers[static_cast<size_t>(handle)];
  const Vec3 target = instance->state.target(handle);
  // Whoever moved the target by other means has put the weight there, too.
  if (!(follower.position() == target)) follower.Reset(target);
  if (def.reach > 0) goal = ClampToReach(instance->state, handle, def.reach, goal);
  follower.Step({def.frequency, def.damping}, goal, def.time_step);
  if (def.reach > 0) {  // it may swing out, and the others may come nearer
    const Vec3 at = follower.position();
    const Vec3 held = ClampToReach(instance->state, handle, def.reach, at);
    if (!(held == at)) follower.HoldAt(held);
  }
  LIMBER_RETURN_IF_FAILED(Ask(TargetEvent(handle, follower.position()), instance));
  instance->followers[static_cast<size_t>(handle)] = follower;
  return {};
}

}  // namespace
}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberFollowDef limberDefaultFollowDef(void) {
  LimberFollowDef def = {};
  def.cookie = kFollowCookie;
  def.struct_size = sizeof(def);
  def.frequency = SpringOptions().frequency;
  def.damping = SpringOptions().damping;
  def.reach = 1;
  return def;
}

LimberResult limberFollow(LimberContext* context, LimberInstanceId instance, int32_t handle,
                          const float goal[3], const LimberFollowDef* def) {
  return CallOn(context, "limberFollow", instance, [&](Instance* of) -> CallStatus {
    if (def == nullptr) return NullArgument("def");
    LimberFollowDef full = limberDefaultFollowDef();
    LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberFollowDef", &full));
    LIMBER_RETURN_IF_FAILED(CheckFollow(full, goal));
    return Follow(full, handle, {goal[0], goal[1], goal[2]}, of);
  });
}

}  // extern "C"
