// limber_vulkan.h for C++17 and later, as limber.hpp is for limber.h.
#pragma once

#include "limber/limber.hpp"
#include "limber/limber_vulkan.h"

namespace limber::api {

// Skinning on one VkDevice and queue; ends before them, and before its context.
class Vulkan : public Owned<LimberVulkanId, limberDestroyVulkan> {
 public:
  Vulkan() = default;

  Vulkan(const Context& context, const LimberVulkanDef& def)
      : Owned(context.get(), Create(context.get(), def)) {}

  void Prepare(const Rig& rig) { Check(limberPrepareVulkanRig(context_, id_, rig.id()), context_); }

  void RecordSkins(const LimberVulkanFrameDef& frame,
                   const std::vector<LimberVulkanSkinDef>& skins) {
    Check(limberRecordVulkanSkins(context_, id_, &frame, skins.data(),
                                  static_cast<uint32_t>(skins.size())),
          context_);
  }

 private:
  static LimberVulkanId Create(LimberContext* context, const LimberVulkanDef& def) {
    LimberVulkanId id = {0, 0};
    Check(limberCreateVulkan(context, &def, &id), context);
    return id;
  }
};

}  // namespace limber::api
