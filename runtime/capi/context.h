// What a context holds: rigs, instances, the last message.
#pragma once

#include "limber/limber.h"

#include "capi/call.h"
#include "capi/slot_table.h"
#include "capi/worker_pool.h"
#include "clips/handle_clips.h"
#include "core/object_pool.h"
#include "core/vector.h"
#include "drive/input_recorder.h"
#include "drive/spring_follower.h"
#include "ray/nearest_hit.h"
#include "rig/rig.h"
#include "skin/cpu_skinner.h"
#include "solve/pose_solver.h"
#include "solve/pose_workspaces.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace limber::capi {

// What one pick needs.
struct PickScratch : NewFromSource {
  Vector<Vec3> positions;  // [D]
  NearestHitFinder finder;
};

// What skinning and picking need: of all instances of a rig, and scratch of those that are at it.
struct SkinShare {
  std::shared_ptr<const SkinSurface> surface;
  ObjectPool<CpuSkinner> idle;
  ObjectPool<PickScratch> idle_picks;
};

// A loaded rig, and what its instances share, made for the first of them.
struct RigEntry : NewFromSource {
  std::shared_ptr<const Rig> rig;
  std::shared_ptr<const HandleClips> clips;
  std::mutex mutex;  // of the rest, while it is made
  std::shared_ptr<PoseWorkspaces> workspaces;
  std::shared_ptr<SkinShare> skins;
};

// What was asked of one handle beside its target.
struct HandleWishes {
  float stiffness = kHeldExactly, weight = 1;
  bool is_turned = false;
  Quaternion rotation = {};
  float rotation_stiffness = kHeldExactly;
};

struct Instance : NewFromSource {
  Instance(const LimberInstanceDef& with, const RigEntry& of, PoseState pose,
           std::shared_ptr<SkinShare> skin)
      : def(with),
        rig(of.rig),
        clips(of.clips),
        state(std::move(pose)),
        skins(std::move(skin)),
        wishes(static_cast<size_t>(rig->num_handles())),
        followers(wishes.size()) {}

  LimberInstanceDef def;
  std::shared_ptr<const Rig> rig;
  std::shared_ptr<const HandleClips> clips;
  PoseState state;
  std::shared_ptr<SkinShare> skins;         // null: made without room for it
  Vector<HandleWishes> wishes;              // [H], for another rig to take over
  Vector<SpringFollower> followers;         // [H]
  std::unique_ptr<InputRecorder> recorder;  // null: nothing is recorded
  LimberSolveDef last_solve = limberDefaultSolveDef();
  std::atomic<bool> in_crowd = false;  // a call about many is at it
};

// What another room keeps in a context, unknown to this one.
struct ContextPart : NewFromSource {
  ContextPart() = default;
  ContextPart(const ContextPart&) = delete;
  ContextPart& operator=(const ContextPart&) = delete;
  virtual ~ContextPart() = default;
};

}  // namespace limber::capi

struct LimberContext : limber::NewFromSource {
  LimberContextDef def;
  const limber::MemorySource* memory = nullptr;  // null: the heap
  limber::capi::SlotTable<limber::capi::RigEntry> rigs;
  limber::capi::SlotTable<limber::capi::Instance> instances;
  limber::capi::SlotTable<limber::capi::ContextPart> vulkans;  // capi_vulkan
  mutable std::mutex message_mutex;
  limber::String message;  // of the last failure
  std::once_flag workers_once;
  std::optional<limber::capi::WorkerPool> workers;  // limber::capi::Workers
};

namespace limber::capi {

CallStatus NullArgument(const char* name);
CallStatus CheckHandle(const Rig& rig, int32_t handle);
CallStatus StaleId(const char* what, uint32_t index, uint32_t generation);

// The context's own threads, made when they are first asked for (std::bad_alloc).
WorkerPool& Workers(LimberContext* context);

// Remembers a failure's message, tells the log, and returns the code. No lock is held in the log.
LimberResult End(LimberContext* context, const char* function, const CallStatus& status);

// Runs the body of an entry point, a CallStatus() that may throw. A null context fails.
template <class Body>
LimberResult Call(LimberContext* context, const char* function, const Body& body) {
  if (context == nullptr) return LIMBER_ERROR_INVALID_ARGUMENT;
  const MemoryScope memory(context->memory);
  const CallStatus status = Catch(body);
  return status.ok() ? LIMBER_SUCCESS : End(context, function, status);
}

// An entry point that is about one rig or one instance: body is a CallStatus(RigEntry*), or a
// CallStatus(Instance*). A stale id fails.
template <class Body>
LimberResult CallOn(LimberContext* context, const char* function, LimberRigId id,
                    const Body& body) {
  return Call(context, function, [&]() -> CallStatus {
    RigEntry* rig = context->rigs.Find({id.index, id.generation});
    return rig == nullptr ? StaleId("rig", id.index, id.generation) : body(rig);
  });
}

template <class Body>
LimberResult CallOn(LimberContext* context, const char* function, LimberInstanceId id,
                    const Body& body) {
  return Call(context, function, [&]() -> CallStatus {
    Instance* instance = context->instances.Find({id.index, id.generation});
    return instance == nullptr ? StaleId("instance", id.index, id.generation) : body(instance);
  });
}

}  // namespace limber::capi
