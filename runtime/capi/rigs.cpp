// limber.h: rigs.
#include "capi/context.h"
#include "core/vector.h"
#include "load/rig_loader.h"

namespace limber::capi {
namespace {

constexpr uint32_t kRigCookie = 0x4C4D4302;

CallStatus ReadRigDef(const LimberRigDef* def, RigLoadOptions* options) {
  LimberRigDef full = limberDefaultRigDef();
  LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberRigDef", &full));
  options->rig_index = full.rig_index;
  return {};
}

// Clips that cannot be read are no reason to have no character.
void Warn(const LimberContext& context, const Vector<std::string>& warnings) {
  if (context.def.log == nullptr) return;
  for (const std::string& warning : warnings)
    context.def.log(context.def.log_user, LIMBER_SEVERITY_WARNING, warning.c_str());
}

CallStatus Load(const Result<GltfFile>& file, const RigLoadOptions& options, LimberContext* context,
                LimberRigId* rig) {
  if (!file.ok()) return file.status();
  auto loaded = LoadRig(*file, options);
  if (!loaded.ok()) return loaded.status();
  auto entry = std::make_unique<RigEntry>();
  entry->rig = std::move(loaded).value();
  Vector<std::string> warnings;
  auto clips = HandleClips::Read(*file, *entry->rig, options.rig_index, &warnings);
  if (!clips.ok()) return clips.status();
  entry->clips = std::move(clips).value();
  Warn(*context, warnings);
  SlotId id;
  if (!context->rigs.Insert(std::move(entry), &id))
    return {LIMBER_ERROR_LIMIT_EXCEEDED, "a million rigs are there already"};
  *rig = {id.index, id.generation};
  return {};
}

std::string NamesOf(const Rig& rig) {
  std::string names;
  for (const RigHandle& handle : rig.tables().handles)
    names += (names.empty() ? "" : ", ") + handle.name;
  return names;
}

}  // namespace
}  // namespace limber::capi

using namespace limber;        // NOLINT(google-build-using-namespace): entry points in C's own
using namespace limber::capi;  // NOLINT(google-build-using-namespace)

extern "C" {

LimberRigDef limberDefaultRigDef(void) {
  LimberRigDef def = {};
  def.cookie = kRigCookie;
  def.struct_size = sizeof(def);
  return def;
}

LimberResult limberLoadRig(LimberContext* context, const char* path, const LimberRigDef* def,
                           LimberRigId* rig) {
  return Call(context, "limberLoadRig", [&]() -> CallStatus {
    if (path == nullptr) return NullArgument("path");
    if (rig == nullptr) return NullArgument("rig");
    RigLoadOptions options;
    LIMBER_RETURN_IF_FAILED(ReadRigDef(def, &options));
    return Load(GltfFile::Open(std::filesystem::u8path(path), options.limits), options, context,
                rig);
  });
}

LimberResult limberLoadRigFromMemory(LimberContext* context, const void* bytes, size_t num_bytes,
                                     const char* name, const LimberRigDef* def, LimberRigId* rig) {
  return Call(context, "limberLoadRigFromMemory", [&]() -> CallStatus {
    if (bytes == nullptr) return NullArgument("bytes");
    if (rig == nullptr) return NullArgument("rig");
    RigLoadOptions options;
    LIMBER_RETURN_IF_FAILED(ReadRigDef(def, &options));
    const std::span file(static_cast<const uint8_t*>(bytes), num_bytes);
    return Load(GltfFile::Parse(file, name == nullptr ? "memory" : name, options.limits), options,
                context, rig);
  });
}

LimberResult limberDestroyRig(LimberContext* context, LimberRigId rig) {
  return CallOn(context, "limberDestroyRig", rig, [&](const RigEntry*) -> CallStatus {
    context->rigs.Remove({rig.index, rig.generation});
    return {};
  });
}

LimberResult limberGetRigInfo(LimberContext* context, LimberRigId rig, LimberRigInfo* info) {
  return CallOn(context, "limberGetRigInfo", rig, [&](const RigEntry* entry) -> CallStatus {
    if (info == nullptr) return NullArgument("info");
    const Rig& from = *entry->rig;
    const SkinMesh& mesh = from.mesh();
    *info = {from.num_handles(),
             from.num_shapes(),
             from.num_groups(),
             from.dimension(),
             mesh.num_draw_vertices,
             mesh.num_triangles(),
             from.diagonal(),
             mesh.triangles.data(),
             mesh.texcoords.empty() ? nullptr : mesh.texcoords.data()};
    return {};
  });
}

LimberResult limberGetNumPrimitives(LimberContext* context, LimberRigId rig, int32_t* count) {
  return CallOn(context, "limberGetNumPrimitives", rig, [&](const RigEntry* entry) -> CallStatus {
    if (count == nullptr) return NullArgument("count");
    *count = static_cast<int32_t>(entry->rig->mesh().primitives.size());
    return {};
  });
}

LimberResult limberGetPrimitiveInfo(LimberContext* context, LimberRigId rig, int32_t primitive,
                                    LimberPrimitiveInfo* info) {
  return CallOn(context, "limberGetPrimitiveInfo", rig, [&](const RigEntry* entry) -> CallStatus {
    if (info == nullptr) return NullArgument("info");
    const Vector<SkinPrimitive>& primitives = entry->rig->mesh().primitives;
    if (primitive < 0 || static_cast<size_t>(primitive) >= primitives.size()) {
      return {LIMBER_ERROR_INVALID_ARGUMENT, "primitive " + std::to_string(primitive) +
                                                 ": there are " +
                                                 std::to_string(primitives.size())};
    }
    const SkinPrimitive& from = primitives[static_cast<size_t>(primitive)];
    *info = {from.first_vertex,  from.num_vertices,   from.first_triangle,
             from.num_triangles, from.gltf_primitive, from.material};
    return {};
  });
}

LimberResult limberGetHandleInfo(LimberContext* context, LimberRigId rig, int32_t handle,
                                 LimberHandleInfo* info) {
  return CallOn(context, "limberGetHandleInfo", rig, [&](const RigEntry* entry) -> CallStatus {
    if (info == nullptr) return NullArgument("info");
    LIMBER_RETURN_IF_FAILED(CheckHandle(*entry->rig, handle));
    const RigHandle& from = entry->rig->tables().handles[static_cast<size_t>(handle)];
    *info = {from.name.c_str(),
             {from.rest_position.x, from.rest_position.y, from.rest_position.z},
             from.pinned ? 1 : 0};
    return {};
  });
}

LimberResult limberFindHandle(LimberContext* context, LimberRigId rig, const char* name,
                              int32_t* handle) {
  return CallOn(context, "limberFindHandle", rig, [&](const RigEntry* entry) -> CallStatus {
    if (name == nullptr) return NullArgument("name");
    if (handle == nullptr) return NullArgument("handle");
    const int found = entry->rig->FindHandle(name);
    if (found < 0) {
      return {LIMBER_ERROR_NOT_FOUND,
              "no handle '" + std::string(name) + "'; there are " + NamesOf(*entry->rig)};
    }
    *handle = found;
    return {};
  });
}

}  // extern "C"
