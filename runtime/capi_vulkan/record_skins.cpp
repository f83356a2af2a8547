// limber_vulkan.h: a frame.
#include "capi_vulkan/vulkan_entry.h"

namespace limber::capi {
namespace {

constexpr uint32_t kFrameCookie = 0x4C4D4312, kSkinCookie = 0x4C4D4313;

VertexStream StreamOfOutput(const LimberVulkanOutput& output) {
  return {output.buffer, output.offset, output.stride};
}

// Adds skins[i] to the entry's jobs; its instance is marked as being in this call.
CallStatus AddJob(LimberContext* context, const LimberVulkanSkinDef& def, VulkanEntry* entry) {
  const LimberInstanceId id = def.instance;
  Instance* instance = context->instances.Find({id.index, id.generation});
  if (instance == nullptr) return StaleId("instance", id.index, id.generation);
  const uint32_t expected = instance->rig->mesh().num_draw_vertices;
  if (def.num_vertices != expected) {
    return {LIMBER_ERROR_INVALID_ARGUMENT, "num_vertices: " + std::to_string(def.num_vertices) +
                                               "; the rig has " + std::to_string(expected)};
  }
  VulkanSkinJob job;
  LIMBER_RETURN_IF_FAILED(FindTables(instance->rig, entry, &job.rig));
  job.transforms = instance->state.transforms();
  job.instance = uint64_t{id.generation} << 32 | id.index;
  job.positions = StreamOfOutput(def.positions);
  job.normals = StreamOfOutput(def.normals);
  job.tangents = StreamOfOutput(def.tangents);
  job.last_positions = StreamOfOutput(def.last_positions);
  job.jumps = def.jumps != 0;
  entry->jobs.push_back(job);
  entry->instances.reserve(entry->jobs.size());
  if (instance->in_crowd.exchange(true, std::memory_order_acquire))
    return {LIMBER_ERROR_INVALID_ARGUMENT, "it is there twice, or in another call of now"};
  entry->instances.push_back(instance);
  return {};
}

CallStatus AddJobs(LimberContext* context, const LimberVulkanSkinDef* skins, uint32_t count,
                   VulkanEntry* entry) {
  DefArray<LimberVulkanSkinDef> array(skins);
  for (uint32_t i = 0; i < count; ++i) {
    LimberVulkanSkinDef def = limberDefaultVulkanSkinDef();
    CallStatus added = ReadDef(array.At(i), "LimberVulkanSkinDef", &def);
    if (added.ok()) added = AddJob(context, def, entry);
    if (!added.ok()) return {added.result, "skins[" + std::to_string(i) + "]: " + added.message};
  }
  return {};
}

void Unmark(VulkanEntry* entry) {
  for (Instance* instance : entry->instances)
    instance->in_crowd.store(false, std::memory_order_release);
  entry->instances.clear();
  entry->jobs.clear();
}

CallStatus RecordFrame(LimberContext* context, const LimberVulkanFrameDef* frame,
                       const LimberVulkanSkinDef* skins, uint32_t count, VulkanEntry* entry) {
  if (frame == nullptr) return NullArgument("frame");
  if (skins == nullptr && count > 0) return NullArgument("skins");
  LimberVulkanFrameDef full = limberDefaultVulkanFrameDef();
  LIMBER_RETURN_IF_FAILED(ReadDef(frame, "LimberVulkanFrameDef", &full));
  if (full.commands == VK_NULL_HANDLE) return NullArgument("frame: commands");
  ForgetRigs(entry);
  LIMBER_RETURN_IF_FAILED(AddJobs(context, skins, count, entry));
  return entry->skinner->Record(full.commands, full.slot, entry->jobs,
                                {full.reader_stage, full.reader_access});
}

}  // namespace
}  // namespace limber::capi

using namespace limber::capi;  // NOLINT(google-build-using-namespace): entry points in C's own

extern "C" {

LimberVulkanSkinDef limberDefaultVulkanSkinDef(void) {
  LimberVulkanSkinDef def = {};
  def.cookie = kSkinCookie;
  def.struct_size = sizeof(def);
  return def;
}

LimberVulkanFrameDef limberDefaultVulkanFrameDef(void) {
  LimberVulkanFrameDef def = {};
  def.cookie = kFrameCookie;
  def.struct_size = sizeof(def);
  def.reader_stage = VK_PIPELINE_STAGE_VERTEX_INPUT_BIT;
  def.reader_access = VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT;
  return def;
}

LimberResult limberRecordVulkanSkins(LimberContext* context, LimberVulkanId vulkan,
                                     const LimberVulkanFrameDef* frame,
                                     const LimberVulkanSkinDef* skins, uint32_t count) {
  return CallOn(context, "limberRecordVulkanSkins", vulkan, [&](VulkanEntry* entry) {
    CallStatus status = Catch([&] { return RecordFrame(context, frame, skins, count, entry); });
    Unmark(entry);
    return status;
  });
}

}  // extern "C"
