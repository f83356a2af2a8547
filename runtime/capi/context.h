// What a context holds: rigs, instances, the last message.
#pragma once

#include "limber/limber.h"

#include "capi/call.h"
#include "capi/slot_table.h"
#include "rig/rig.h"
#include "skin/cpu_skinner.h"
#include "solve/pose_solver.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace limber::capi {

// A loaded rig, and the model that its instances share, made for the first of them.
struct RigEntry {
  std::shared_ptr<const Rig> rig;
  std::mutex mutex;  // of the model
  std::shared_ptr<const PoseModel> model;
};

struct Instance {
  PoseState state;
  std::optional<CpuSkinner> skinner;
};

}  // namespace limber::capi

struct LimberContext {
  LimberContextDef def;
  limber::capi::SlotTable<limber::capi::RigEntry> rigs;
  limber::capi::SlotTable<limber::capi::Instance> instances;
  mutable std::mutex message_mutex;
  std::string message;  // of the last failure
};

namespace limber::capi {

// Remembers a failure's message, tells the log, and returns the code. No lock is held in the log.
LimberResult End(LimberContext* context, const char* function, const CallStatus& status);

// Runs the body of an entry point, a CallStatus() that may throw. A null context fails.
template <class Body>
LimberResult Call(LimberContext* context, const char* function, const Body& body) {
  if (context == nullptr) return LIMBER_ERROR_INVALID_ARGUMENT;
  const CallStatus status = Catch(body);
  return status.ok() ? LIMBER_SUCCESS : End(context, function, status);
}

// Null, with *status saying so, for a stale id.
RigEntry* FindRig(const LimberContext& context, LimberRigId id, CallStatus* status);
Instance* FindInstance(const LimberContext& context, LimberInstanceId id, CallStatus* status);

CallStatus NullArgument(const char* name);

}  // namespace limber::capi
