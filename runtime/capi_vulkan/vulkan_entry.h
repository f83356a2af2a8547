// What is behind a LimberVulkanId.
#pragma once

#include "limber/limber_vulkan.h"

#include "capi/context.h"
#include "core/vector.h"
#include "skin_vulkan/vulkan_skinner.h"

#include <memory>

namespace limber::capi {

struct VulkanEntry : ContextPart {
  // A rig that is on the device, as long as anybody has it.
  struct DeviceRig {
    std::weak_ptr<const Rig> rig;
    const VulkanSkinRig* tables;
  };

  explicit VulkanEntry(const LimberVulkanDef& with) : def(with) {}

  LimberVulkanDef def;
  std::unique_ptr<VulkanSkinner> skinner;
  Vector<DeviceRig> rigs;
  Vector<VulkanSkinJob> jobs;   // of the frame that is being recorded
  Vector<Instance*> instances;  // theirs, marked
};

// The rig's tables on the device, made where they are not there yet.
CallStatus FindTables(const std::shared_ptr<const Rig>& rig, VulkanEntry* entry,
                      const VulkanSkinRig** tables);

// Frees the tables of rigs that nobody has any more.
void ForgetRigs(VulkanEntry* entry);

// An entry point that is about one LimberVulkanId: body is a CallStatus(VulkanEntry*).
template <class Body>
LimberResult CallOn(LimberContext* context, const char* function, LimberVulkanId id,
                    const Body& body) {
  return Call(context, function, [&]() -> CallStatus {
    ContextPart* part = context->vulkans.Find({id.index, id.generation});
    return part == nullptr ? StaleId("vulkan", id.index, id.generation)
                           : body(static_cast<VulkanEntry*>(part));
  });
}

}  // namespace limber::capi
