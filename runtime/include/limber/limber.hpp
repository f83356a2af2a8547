// limber.h for C++17 and later: objects that end what they own, exceptions that carry the message.
// Header only; nothing of it crosses the library's border. What each call does, costs and refuses
// is said in limber.h; threads too: a Context may be used by many at once, an Instance by one.
#pragma once

#include "limber/limber.h"

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace limber::api {

class Error : public std::runtime_error {
 public:
  Error(LimberResult result, const std::string& message)
      : std::runtime_error(message.empty() ? limberResultString(result) : message),
        result_(result) {}

  LimberResult result() const noexcept { return result_; }

 private:
  LimberResult result_;
};

inline std::string LastMessage(const LimberContext* context) {
  std::string message(limberGetLastMessage(context, nullptr, 0), '\0');
  limberGetLastMessage(context, message.data(), message.size() + 1);
  return message;
}

inline void Check(LimberResult result, const LimberContext* context) {
  if (result != LIMBER_SUCCESS) throw Error(result, LastMessage(context));
}

using Point = std::array<float, 3>;
using Quaternion = std::array<float, 4>;  // x, y, z, w

// Holds an id, and ends it. Its context must outlive it.
template <class Id, LimberResult (*kDestroy)(LimberContext*, Id)>
class Owned {
 public:
  Owned() = default;

  Owned(LimberContext* context, Id id) noexcept : context_(context), id_(id) {}

  Owned(Owned&& other) noexcept { Swap(other); }

  Owned& operator=(Owned&& other) noexcept {
    Swap(other);
    return *this;
  }

  ~Owned() {
    if (context_ != nullptr) kDestroy(context_, id_);
  }

  Id id() const noexcept { return id_; }

 protected:
  LimberContext* context_ = nullptr;
  Id id_ = {0, 0};

 private:
  void Swap(Owned& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(id_, other.id_);
  }
};

// One character in the scene.
class Instance : public Owned<LimberInstanceId, limberDestroyInstance> {
 public:
  Instance() = default;

  Instance(LimberContext* context, LimberRigId rig, const LimberInstanceDef* def = nullptr)
      : Owned(context, Create(context, rig, def)) {}

  void SwitchRig(LimberRigId rig) { Check(limberSwitchRig(context_, id_, rig), context_); }

  void SetTarget(int32_t handle, const Point& position) {
    Check(limberSetTarget(context_, id_, handle, position.data()), context_);
  }

  void SetTargetRotation(int32_t handle, const Quaternion& rotation,
                         float stiffness = LIMBER_HELD_EXACTLY) {
    Check(limberSetTargetRotation(context_, id_, handle, rotation.data(), stiffness), context_);
  }

  void ClearTargetRotation(int32_t handle) {
    Check(limberClearTargetRotation(context_, id_, handle), context_);
  }

  void Pin(int32_t handle) { Check(limberPin(context_, id_, handle), context_); }

  void Unpin(int32_t handle) { Check(limberUnpin(context_, id_, handle), context_); }

  void SetStiffness(int32_t handle, float stiffness) {
    Check(limberSetStiffness(context_, id_, handle, stiffness), context_);
  }

  void SetWeight(int32_t handle, float weight) {
    Check(limberSetWeight(context_, id_, handle, weight), context_);
  }

  LimberHandleState Handle(int32_t handle) const {
    LimberHandleState state = {};
    Check(limberGetHandle(context_, id_, handle, &state), context_);
    return state;
  }

  int32_t Grab(const LimberSkinPoint& point, float stiffness = LIMBER_HELD_EXACTLY) {
    int32_t grab = -1;
    Check(limberGrab(context_, id_, &point, stiffness, &grab), context_);
    return grab;
  }

  void SetGrabTarget(int32_t grab, const Point& position) {
    Check(limberSetGrabTarget(context_, id_, grab, position.data()), context_);
  }

  void Release(int32_t grab) { Check(limberRelease(context_, id_, grab), context_); }

  LimberPickHit Pick(const Point& origin, const Point& direction) const {
    LimberPickHit hit = {};
    Check(limberPick(context_, id_, origin.data(), direction.data(), &hit), context_);
    return hit;
  }

  Point Place(const LimberSkinPoint& point) const {
    Point position = {};
    Check(limberGetPlace(context_, id_, &point, position.data()), context_);
    return position;
  }

  void ResetToRest() { Check(limberResetToRest(context_, id_), context_); }

  void Follow(int32_t handle, const Point& goal, const LimberFollowDef& def) {
    Check(limberFollow(context_, id_, handle, goal.data(), &def), context_);
  }

  void ApplyClip(const LimberClipDef& def) {
    Check(limberApplyClip(context_, id_, &def), context_);
  }

  std::vector<unsigned char> Recording() const {
    size_t size = 0;
    Check(limberGetRecording(context_, id_, nullptr, 0, &size), context_);
    std::vector<unsigned char> bytes(size);
    Check(limberGetRecording(context_, id_, bytes.data(), size, &size), context_);
    return bytes;
  }

  LimberSolveReport Solve(const LimberSolveDef* def = nullptr) {
    LimberSolveReport report = {};
    Check(limberSolve(context_, id_, def, &report), context_);
    return report;
  }

  void Skin(const LimberSkinDef& def) { Check(limberSkin(context_, id_, &def), context_); }

 private:
  static LimberInstanceId Create(LimberContext* context, LimberRigId rig,
                                 const LimberInstanceDef* def) {
    LimberInstanceId id = {0, 0};
    Check(limberCreateInstance(context, rig, def, &id), context);
    return id;
  }
};

// A loaded character. Its instances need not end before it.
class Rig : public Owned<LimberRigId, limberDestroyRig> {
 public:
  using Owned::Owned;

  LimberRigInfo Info() const {
    LimberRigInfo info = {};
    Check(limberGetRigInfo(context_, id_, &info), context_);
    return info;
  }

  int32_t NumPrimitives() const {
    int32_t count = 0;
    Check(limberGetNumPrimitives(context_, id_, &count), context_);
    return count;
  }

  LimberPrimitiveInfo PrimitiveInfo(int32_t primitive) const {
    LimberPrimitiveInfo info = {};
    Check(limberGetPrimitiveInfo(context_, id_, primitive, &info), context_);
    return info;
  }

  LimberHandleInfo HandleInfo(int32_t handle) const {
    LimberHandleInfo info = {};
    Check(limberGetHandleInfo(context_, id_, handle, &info), context_);
    return info;
  }

  int32_t FindHandle(const std::string& name) const {
    int32_t handle = -1;
    Check(limberFindHandle(context_, id_, name.c_str(), &handle), context_);
    return handle;
  }

  int32_t FindClip(const std::string& name) const {
    int32_t clip = -1;
    Check(limberFindClip(context_, id_, name.c_str(), &clip), context_);
    return clip;
  }

  Instance MakeInstance(const LimberInstanceDef* def = nullptr) const {
    return Instance(context_, id_, def);
  }
};

class Context {
 public:
  explicit Context(const LimberContextDef& def = limberDefaultContextDef()) {
    Check(limberCreateContext(&def, &context_), nullptr);
  }

  Context(Context&& other) noexcept : context_(std::exchange(other.context_, nullptr)) {}

  Context& operator=(Context&& other) noexcept {
    std::swap(context_, other.context_);
    return *this;
  }

  ~Context() { limberDestroyContext(context_); }

  LimberContext* get() const noexcept { return context_; }

  Rig LoadRig(const std::string& path, const LimberRigDef* def = nullptr) {
    LimberRigId id = {0, 0};
    Check(limberLoadRig(context_, path.c_str(), def, &id), context_);
    return Rig(context_, id);
  }

  Rig LoadRig(const void* bytes, size_t num_bytes, const std::string& name,
              const LimberRigDef* def = nullptr) {
    LimberRigId id = {0, 0};
    Check(limberLoadRigFromMemory(context_, bytes, num_bytes, name.c_str(), def, &id), context_);
    return Rig(context_, id);
  }

  // The first failure is thrown; all others are solved nevertheless.
  void SolveMany(const std::vector<LimberInstanceId>& instances,
                 const LimberSolveDef* def = nullptr) {
    Check(limberSolveMany(context_, instances.data(), static_cast<uint32_t>(instances.size()), def,
                          nullptr, nullptr),
          context_);
  }

 private:
  LimberContext* context_ = nullptr;
};

}  // namespace limber::api
