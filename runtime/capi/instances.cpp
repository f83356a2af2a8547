// limber.h: instances.
#include "capi/context.h"
#include "capi/inputs.h"
#include "capi/instance_calls.h"
#include "solve/pose_model.h"

#include <algorithm>
#include <cstring>

namespace limber::capi {
namespace {

constexpr uint32_t kInstanceCookie = 0x4C4D4303, kSolveCookie = 0x4C4D4304,
                   kSkinCookie = 0x4C4D4305;

// What a rig's instances share, made where there is nothing yet.
Result<std::shared_ptr<PoseWorkspaces>> WorkspacesOf(RigEntry* entry) {
  const std::lock_guard lock(entry->mutex);
  if (entry->workspaces == nullptr) {
    auto model = PoseModel::Create(entry->rig);
    if (!model.ok()) return model.status();
    entry->workspaces = MakeShared<PoseWorkspaces>(std::move(model).value(), PoseRoom());
  }
  return entry->workspaces;
}

Result<std::shared_ptr<SkinShare>> SkinsOf(RigEntry* entry) {
  const std::lock_guard lock(entry->mutex);
  if (entry->skins == nullptr) {
    auto surface = SkinSurface::Create(entry->rig->mesh(), entry->rig->tables().space);
    if (!surface.ok()) return surface.status();
    auto skins = MakeShared<SkinShare>();
    skins->surface = std::move(surface).value();
    entry->skins = std::move(skins);
  }
  return entry->skins;
}

PoseOptions OptionsOf(const LimberSolveDef& def) {
  PoseOptions options;
  options.iterations = def.iterations;
  options.lambda = def.nearness;
  options.rotations = def.rotations != 0;
  options.guaranteed = def.guaranteed != 0;
  options.settle_tolerance = def.settle_tolerance;
  options.stretch_limit = def.stretch_limit;
  options.smoothing = def.smoothing;
  options.time_step = def.time_step;
  options.time_budget = def.time_budget;
  return options;
}

CallStatus CheckOutput(const LimberVertexOutput& output, const char* name, size_t size) {
  if (output.data == nullptr || (output.stride >= size && output.stride % 4 == 0)) return {};
  return {LIMBER_ERROR_INVALID_ARGUMENT,
          std::string(name) + ": a stride of " + std::to_string(output.stride) +
              " bytes; a multiple of 4 is needed, of " + std::to_string(size) + " or more"};
}

CallStatus CheckSkinDef(const LimberSkinDef& def, const Instance& instance) {
  LIMBER_RETURN_IF_FAILED(CheckOutput(def.positions, "positions", sizeof(Vec3)));
  LIMBER_RETURN_IF_FAILED(CheckOutput(def.normals, "normals", sizeof(Vec3)));
  LIMBER_RETURN_IF_FAILED(CheckOutput(def.tangents, "tangents", sizeof(Tangent)));
  if (instance.skins == nullptr) return WithoutSkin();
  const uint32_t expected = instance.state.rig().mesh().num_draw_vertices;
  if (def.num_vertices == expected) return {};
  return {LIMBER_ERROR_INVALID_ARGUMENT, "num_vertices: " + std::to_string(def.num_vertices) +
                                             "; the rig has " + std::to_string(expected)};
}

}  // namespace

CallStatus WithoutSkin() {
  return {LIMBER_ERROR_UNSUPPORTED,
          "the instance was made without room for it (LimberInstanceDef::skin)"};
}

CallStatus MakeInstance(const LimberInstanceDef& def, RigEntry* entry,
                        std::unique_ptr<Instance>* instance) {
  auto shared = WorkspacesOf(entry);
  if (!shared.ok()) return shared.status();
  PoseRoom room;
  room.grabs = def.max_grabs;
  room.rotations = def.max_rotations;
  room.guaranteed = def.guaranteed != 0;
  auto state = (*shared)->HasRoomFor(room) ? PoseState::Create(*shared, room)
                                           : PoseState::Create((*shared)->model(), room);
  if (!state.ok()) return state.status();
  std::shared_ptr<SkinShare> skins;
  if (def.skin != 0) {
    auto made = SkinsOf(entry);
    if (!made.ok()) return made.status();
    skins = std::move(made).value();
  }
  *instance = std::make_unique<Instance>(def, *entry, std::move(state).value(), std::move(skins));
  if (def.record != 0) (*instance)->recorder = MakeRecorder(*entry->rig, room);
  return {};
}

CallStatus SolveInstance(const LimberSolveDef& def, Instance* instance, LimberSolveReport* report) {
  PoseReport solved;
  const PoseOptions options = OptionsOf(def);
  LIMBER_RETURN_IF_FAILED(instance->state.Solve(options, &solved));
  instance->last_solve = def;
  if (instance->recorder != nullptr) RecordSolve(options, solved.iterations, instance);
  if (report != nullptr) {
    *report = {solved.energy, solved.change, solved.iterations, solved.settled ? 1 : 0,
               solved.at_rest ? 1 : 0};
  }
  return {};
}

CallStatus SkinInstance(const LimberSkinDef* def, Instance* instance) {
  if (def == nullptr) return NullArgument("def");
  LimberSkinDef full = limberDefaultSkinDef();
  LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberSkinDef", &full));
  LIMBER_RETURN_IF_FAILED(CheckSkinDef(full, *instance));
  std::unique_ptr<CpuSkinner> skinner = instance->skins->idle.Take();
  if (skinner == nullptr) {
    auto made = CpuSkinner::CreateWithoutResults(instance->skins->surface);
    if (!made.ok()) return made.status();
    skinner = std::make_unique<CpuSkinner>(std::move(made).value());
  }
  SkinOutputs outputs;
  outputs.positions = {full.positions.data, full.positions.stride};
  outputs.normals = {full.normals.data, full.normals.stride};
  outputs.tangents = {full.tangents.data, full.tangents.stride};
  Bounds bounds;
  outputs.bounds = full.bounds == nullptr ? nullptr : &bounds;
  const Status skinned = skinner->SkinInto(instance->state.transforms(), outputs);
  if (skinned.ok() && full.bounds != nullptr) std::memcpy(full.bounds, &bounds, sizeof(bounds));
  instance->skins->idle.Give(std::move(skinner));
  return skinned;
}

}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberInstanceDef limberDefaultInstanceDef(void) {
  LimberInstanceDef def = {};
  def.cookie = kInstanceCookie;
  def.struct_size = sizeof(def);
  def.max_rotations = PoseRoom().rotations;
  def.max_grabs = PoseRoom().grabs;
  def.skin = 1;
  return def;
}

LimberSolveDef limberDefaultSolveDef(void) {
  LimberSolveDef def = {};
  def.cookie = kSolveCookie;
  def.struct_size = sizeof(def);
  def.iterations = PoseOptions().iterations;
  def.nearness = PoseOptions().lambda;
  def.rotations = 1;
  return def;
}

LimberSkinDef limberDefaultSkinDef(void) {
  LimberSkinDef def = {};
  def.cookie = kSkinCookie;
  def.struct_size = sizeof(def);
  def.positions.stride = def.normals.stride = sizeof(Vec3);
  def.tangents.stride = sizeof(Tangent);
  return def;
}

LimberResult limberCreateInstance(LimberContext* context, LimberRigId rig,
                                  const LimberInstanceDef* def, LimberInstanceId* instance) {
  return CallOn(context, "limberCreateInstance", rig, [&](RigEntry* entry) -> CallStatus {
    if (instance == nullptr) return NullArgument("instance");
    LimberInstanceDef full = limberDefaultInstanceDef();
    LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberInstanceDef", &full));
    std::unique_ptr<Instance> made;
    LIMBER_RETURN_IF_FAILED(MakeInstance(full, entry, &made));
    SlotId id;
    if (!context->instances.Insert(std::move(made), &id))
      return {LIMBER_ERROR_LIMIT_EXCEEDED, "a million instances are there already"};
    *instance = {id.index, id.generation};
    return {};
  });
}

LimberResult limberDestroyInstance(LimberContext* context, LimberInstanceId instance) {
  return CallOn(context, "limberDestroyInstance", instance, [&](Instance*) -> CallStatus {
    context->instances.Remove({instance.index, instance.generation});
    return {};
  });
}

LimberResult limberSolve(LimberContext* context, LimberInstanceId instance,
                         const LimberSolveDef* def, LimberSolveReport* report) {
  return CallOn(context, "limberSolve", instance, [&](Instance* of) -> CallStatus {
    LimberSolveDef full = limberDefaultSolveDef();
    LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberSolveDef", &full));
    return SolveInstance(full, of, report);
  });
}

LimberResult limberGetBlendWeights(LimberContext* context, LimberInstanceId instance,
                                   double* weights, size_t count) {
  return CallOn(context, "limberGetBlendWeights", instance, [&](Instance* of) -> CallStatus {
    if (weights == nullptr) return NullArgument("weights");
    const std::span<const double> from = of->state.blend_weights();
    if (count != from.size()) {
      return {LIMBER_ERROR_INVALID_ARGUMENT, "count: " + std::to_string(count) + "; there are " +
                                                 std::to_string(from.size()) +
                                                 ", groups times shapes"};
    }
    std::copy(from.begin(), from.end(), weights);
    return {};
  });
}

LimberResult limberSkin(LimberContext* context, LimberInstanceId instance,
                        const LimberSkinDef* def) {
  return CallOn(context, "limberSkin", instance,
                [&](Instance* of) -> CallStatus { return SkinInstance(def, of); });
}

}  // extern "C"
