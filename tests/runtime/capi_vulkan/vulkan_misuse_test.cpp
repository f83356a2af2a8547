// Every misuse of limber_vulkan.h gets a code and one line; none crashes or records anything.
#include "capi_vulkan_fixture.h"
#include "core/vector.h"

#include <functional>

namespace limber::test {
namespace {

class CapiVulkanMisuse : public CapiVulkanTest {
 protected:
  void Expect(LimberResult expected, const char* says, LimberResult result) {
    EXPECT_EQ(result, expected) << says << ": " << Message();
    EXPECT_NE(Message().find(says), std::string::npos) << Message();
    EXPECT_EQ(Message().find('\n'), std::string::npos);
  }

  // No command buffer would survive being recorded into: it is none.
  LimberResult Record(const Vector<LimberVulkanSkinDef>& skins, uint32_t slot = 0) {
    LimberVulkanFrameDef frame = limberDefaultVulkanFrameDef();
    frame.commands = reinterpret_cast<VkCommandBuffer>(uintptr_t{16});
    frame.slot = slot;
    return limberRecordVulkanSkins(context_, vulkan_, &frame, skins.data(),
                                   static_cast<uint32_t>(skins.size()));
  }
};

TEST_F(CapiVulkanMisuse, Creation) {
  LimberVulkanId out = {5, 6};
  LimberVulkanDef def = DefOf(*device_);
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "vulkan: is null",
         limberCreateVulkan(context_, &def, nullptr));
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "def: is null",
         limberCreateVulkan(context_, nullptr, &out));
  LimberVulkanDef bad = def;
  bad.cookie = 0;
  Expect(LIMBER_ERROR_STRUCT_NOT_DEFAULT, "limberDefaultVulkanDef()",
         limberCreateVulkan(context_, &bad, &out));
  bad = def;
  bad.struct_size += 8;
  Expect(LIMBER_ERROR_VERSION_MISMATCH, "newer limber.h", limberCreateVulkan(context_, &bad, &out));
  bad = def;
  bad.device = VK_NULL_HANDLE;
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "is null", limberCreateVulkan(context_, &bad, &out));
  bad = def;
  bad.get_instance_proc_addr = [](VkInstance, const char*) -> PFN_vkVoidFunction {
    return nullptr;
  };
  Expect(LIMBER_ERROR_DEVICE, "has no vk", limberCreateVulkan(context_, &bad, &out));
  bad = def;
  bad.frames_in_flight = 99;
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "99 frames", limberCreateVulkan(context_, &bad, &out));
  bad = def;
  bad.destroy_buffer = [](void*, const LimberVulkanBuffer*) {};
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "both or none", limberCreateVulkan(context_, &bad, &out));
  EXPECT_EQ(out.index, 5u);
  EXPECT_EQ(out.generation, 6u);
}

TEST_F(CapiVulkanMisuse, IdsThatAreGone) {
  LimberVulkanId gone;
  const LimberVulkanDef def = DefOf(*device_);
  ASSERT_EQ(limberCreateVulkan(context_, &def, &gone), LIMBER_SUCCESS);
  ASSERT_EQ(limberDestroyVulkan(context_, gone), LIMBER_SUCCESS);
  Expect(LIMBER_ERROR_STALE_ID, "vulkan", limberDestroyVulkan(context_, gone));
  Expect(LIMBER_ERROR_STALE_ID, "vulkan", limberPrepareVulkanRig(context_, gone, rig_));
  Expect(LIMBER_ERROR_STALE_ID, "rig 9.9", limberPrepareVulkanRig(context_, vulkan_, {9, 9}));
  const LimberVulkanFrameDef frame = limberDefaultVulkanFrameDef();
  Expect(LIMBER_ERROR_STALE_ID, "vulkan 0.0",
         limberRecordVulkanSkins(context_, {}, &frame, nullptr, 0));
}

TEST_F(CapiVulkanMisuse, Frames) {
  const uint32_t count = info_.num_vertices;
  const VulkanBuffer vertices = MakeVertices(*device_, count);
  const LimberVulkanSkinDef good = SkinInto(vertices.handle(), 0, instance_, count);
  LimberVulkanFrameDef frame = limberDefaultVulkanFrameDef();
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "commands: is null",
         limberRecordVulkanSkins(context_, vulkan_, &frame, &good, 1));
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "frame: is null",
         limberRecordVulkanSkins(context_, vulkan_, nullptr, &good, 1));
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "skins: is null",
         limberRecordVulkanSkins(context_, vulkan_, &frame, nullptr, 1));
  frame.cookie = 1;
  Expect(LIMBER_ERROR_STRUCT_NOT_DEFAULT, "limberDefaultVulkanFrameDef()",
         limberRecordVulkanSkins(context_, vulkan_, &frame, &good, 1));
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "frame 2 of 2", Record({good}, 2));
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "skins[1]: it is there twice", Record({good, good}));
  LimberVulkanSkinDef bad = good;
  bad.instance.generation += 1;
  Expect(LIMBER_ERROR_STALE_ID, "skins[1]: instance", Record({good, bad}));
  bad = good;
  bad.num_vertices = count - 1;
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "skins[0]: num_vertices", Record({bad}));
  bad = good;
  bad.cookie = 3;
  Expect(LIMBER_ERROR_STRUCT_NOT_DEFAULT, "skins[0]: LimberVulkanSkinDef", Record({bad}));
  bad = good;
  bad.tangents.stride = 12;
  Expect(LIMBER_ERROR_INVALID_ARGUMENT, "job 0: tangents: stride 12", Record({bad}));
  // Nothing is left marked or half done.
  ExpectSkinned(RunFrame(device_, vulkan_, 0, {good}, vertices), 0, instance_);
}

// A caller that was compiled with a shorter Def: what it does not know is as by default.
TEST_F(CapiVulkanMisuse, OlderDefs_AreCompletedElementByElement) {
  LimberInstanceId other;
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_SUCCESS);
  const uint32_t count = info_.num_vertices;
  const VulkanBuffer vertices = MakeVertices(*device_, 2 * count);
  constexpr size_t kOldSize = offsetof(LimberVulkanSkinDef, last_positions);
  Vector<LimberVulkanSkinDef> skins(2, limberDefaultVulkanSkinDef());
  for (size_t i = 0; i < 2; ++i) {
    LimberVulkanSkinDef def = SkinInto(vertices.handle(), i * count * sizeof(HostVertex),
                                       i == 0 ? instance_ : other, count);
    def.struct_size = kOldSize;
    std::memcpy(reinterpret_cast<char*>(skins.data()) + i * kOldSize, &def, kOldSize);
  }
  const auto got = RunFrame(device_, vulkan_, 0, skins, vertices);
  ExpectSkinned(got, 0, instance_);
  ExpectSkinned(got, count, other);
}

}  // namespace
}  // namespace limber::test
