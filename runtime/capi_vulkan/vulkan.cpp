// limber_vulkan.h: devices and rigs on them.
#include "capi_vulkan/vulkan_entry.h"

namespace limber::capi {
namespace {

constexpr uint32_t kVulkanCookie = 0x4C4D4311;

VkResult CreateBuffer(void* user, const VkBufferCreateInfo& info, VkMemoryPropertyFlags required,
                      VkMemoryPropertyFlags preferred, VulkanHostBuffer* buffer) {
  const auto& def = *static_cast<const LimberVulkanDef*>(user);
  LimberVulkanBuffer made = {};
  const VkResult result = def.create_buffer(def.buffer_user, &info, required, preferred, &made);
  if (result == VK_SUCCESS) *buffer = {made.buffer, made.mapped, made.allocation};
  return result;
}

void DestroyBuffer(void* user, const VulkanHostBuffer& buffer) {
  const auto& def = *static_cast<const LimberVulkanDef*>(user);
  const LimberVulkanBuffer made = {buffer.buffer, buffer.mapped, buffer.allocation};
  def.destroy_buffer(def.buffer_user, &made);
}

// `def` must stay where it is.
VulkanHost HostOf(LimberVulkanDef* def) {
  VulkanHost host;
  host.instance = def->instance;
  host.physical_device = def->physical_device;
  host.device = def->device;
  host.get_instance_proc_addr = def->get_instance_proc_addr;
  host.callbacks = def->callbacks;
  host.pipeline_cache = def->pipeline_cache;
  if (def->create_buffer != nullptr) host.memory.create = CreateBuffer;
  if (def->destroy_buffer != nullptr) host.memory.destroy = DestroyBuffer;
  host.memory.user = def;
  return host;
}

CallStatus Create(const LimberVulkanDef* def, std::unique_ptr<VulkanEntry>* entry) {
  if (def == nullptr) return NullArgument("def");
  LimberVulkanDef full = limberDefaultVulkanDef();
  LIMBER_RETURN_IF_FAILED(ReadDef(def, "LimberVulkanDef", &full));
  auto made = std::make_unique<VulkanEntry>(full);
  VulkanSkinnerOptions options;
  options.frames_in_flight = full.frames_in_flight;
  auto skinner = VulkanSkinner::Create(HostOf(&made->def), options);
  if (!skinner.ok()) return skinner.status();
  made->skinner = std::move(skinner).value();
  *entry = std::move(made);
  return {};
}

}  // namespace

CallStatus FindTables(const std::shared_ptr<const Rig>& rig, VulkanEntry* entry,
                      const VulkanSkinRig** tables) {
  for (const VulkanEntry::DeviceRig& known : entry->rigs) {
    if (known.rig.owner_before(rig) || rig.owner_before(known.rig)) continue;
    *tables = known.tables;
    return {};
  }
  entry->rigs.reserve(entry->rigs.size() + 1);
  const auto made = entry->skinner->AddRig(rig->mesh(), rig->tables().space);
  if (!made.ok()) return made.status();
  entry->rigs.push_back({rig, *made});
  *tables = *made;
  return {};
}

void ForgetRigs(VulkanEntry* entry) {
  std::erase_if(entry->rigs, [entry](const VulkanEntry::DeviceRig& known) {
    if (!known.rig.expired()) return false;
    entry->skinner->RemoveRig(known.tables);
    return true;
  });
}

}  // namespace limber::capi

using namespace limber::capi;  // NOLINT(google-build-using-namespace): entry points in C's own

extern "C" {

LimberVulkanDef limberDefaultVulkanDef(void) {
  LimberVulkanDef def = {};
  def.cookie = kVulkanCookie;
  def.struct_size = sizeof(def);
  def.frames_in_flight = 2;
  return def;
}

LimberResult limberCreateVulkan(LimberContext* context, const LimberVulkanDef* def,
                                LimberVulkanId* vulkan) {
  return Call(context, "limberCreateVulkan", [&]() -> CallStatus {
    if (vulkan == nullptr) return NullArgument("vulkan");
    std::unique_ptr<VulkanEntry> made;
    LIMBER_RETURN_IF_FAILED(Create(def, &made));
    SlotId id;
    if (!context->vulkans.Insert(std::move(made), &id))
      return {LIMBER_ERROR_LIMIT_EXCEEDED, "there are too many"};
    *vulkan = {id.index, id.generation};
    return {};
  });
}

LimberResult limberDestroyVulkan(LimberContext* context, LimberVulkanId vulkan) {
  return CallOn(context, "limberDestroyVulkan", vulkan, [&](VulkanEntry*) -> CallStatus {
    context->vulkans.Remove({vulkan.index, vulkan.generation});
    return {};
  });
}

LimberResult limberPrepareVulkanRig(LimberContext* context, LimberVulkanId vulkan,
                                    LimberRigId rig) {
  return CallOn(context, "limberPrepareVulkanRig", vulkan, [&](VulkanEntry* entry) -> CallStatus {
    const RigEntry* of = context->rigs.Find({rig.index, rig.generation});
    if (of == nullptr) return StaleId("rig", rig.index, rig.generation);
    const limber::VulkanSkinRig* tables = nullptr;
    return FindTables(of->rig, entry, &tables);
  });
}

}  // extern "C"
