// limber_vulkan.h: frames as an engine records them.
#include "capi_vulkan_fixture.h"
#include "core/vector.h"

namespace limber::test {
namespace {

class CapiVulkan : public CapiVulkanTest {};

TEST_F(CapiVulkan, RecordedSkins_AreThoseOfTheCpu) {
  LimberInstanceId other;
  ASSERT_EQ(limberCreateInstance(context_, rig_, nullptr, &other), LIMBER_SUCCESS);
  ASSERT_EQ(limberPrepareVulkanRig(context_, vulkan_, rig_), LIMBER_SUCCESS) << Message();
  const uint32_t count = info_.num_vertices;
  const VulkanBuffer vertices = MakeVertices(*device_, 2 * count);
  const Vector<LimberVulkanSkinDef> skins = {
      SkinInto(vertices.handle(), 0, instance_, count),
      SkinInto(vertices.handle(), count * sizeof(HostVertex), other, count)};
  Vector<HostVertex> before;
  for (uint32_t frame = 0; frame < 4; ++frame) {
    Move(instance_, 0.1f * static_cast<float>(frame) * info_.diagonal);
    Move(other, -0.05f * static_cast<float>(frame) * info_.diagonal);
    const auto got = RunFrame(device_, vulkan_, frame % 2, skins, vertices);
    ExpectSkinned(got, 0, instance_);
    ExpectSkinned(got, count, other);
    for (size_t i = 0; i < got.size(); ++i) {
      const float* expected = frame == 0 ? got[i].position : before[i].position;
      ASSERT_EQ(std::memcmp(got[i].last, expected, sizeof(got[i].last)), 0) << frame << ' ' << i;
    }
    before = got;
  }
}

TEST_F(CapiVulkan, InstancesWithoutRoomForTheCpu_AreSkinned) {
  LimberInstanceDef def = limberDefaultInstanceDef();
  def.skin = 0;
  LimberInstanceId lean;
  ASSERT_EQ(limberCreateInstance(context_, rig_, &def, &lean), LIMBER_SUCCESS);
  Move(lean, 0.2f * info_.diagonal);
  Move(instance_, 0.2f * info_.diagonal);
  const VulkanBuffer vertices = MakeVertices(*device_, info_.num_vertices);
  const auto got = RunFrame(device_, vulkan_, 0,
                            {SkinInto(vertices.handle(), 0, lean, info_.num_vertices)}, vertices);
  ExpectSkinned(got, 0, instance_);
}

// As when a character was baked again while the game runs.
TEST_F(CapiVulkan, RigsThatAreGone_LeaveTheDevice) {
  Vector<VkBuffer> out;
  LimberVulkanDef def = DefOf(*device_);

  struct Counted {
    const VulkanApi* api;
    Vector<std::unique_ptr<VulkanBuffer>> out;
  } counted{&device_->api(), {}};

  def.buffer_user = &counted;
  def.create_buffer = [](void* user, const VkBufferCreateInfo* info, VkMemoryPropertyFlags required,
                         VkMemoryPropertyFlags preferred, LimberVulkanBuffer* buffer) {
    auto* self = static_cast<Counted*>(user);
    auto made = std::make_unique<VulkanBuffer>();
    if (!made->Create(*self->api, info->size, info->usage, {required, preferred}).ok())
      return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    *buffer = {made->handle(), made->mapped(), made.get()};
    self->out.push_back(std::move(made));
    return VK_SUCCESS;
  };
  def.destroy_buffer = [](void* user, const LimberVulkanBuffer* buffer) {
    std::erase_if(static_cast<Counted*>(user)->out,
                  [buffer](const auto& made) { return made.get() == buffer->allocation; });
  };
  LimberVulkanId vulkan;
  ASSERT_EQ(limberCreateVulkan(context_, &def, &vulkan), LIMBER_SUCCESS) << Message();
  const VulkanBuffer vertices = MakeVertices(*device_, info_.num_vertices);
  const Vector<LimberVulkanSkinDef> skins = {
      SkinInto(vertices.handle(), 0, instance_, info_.num_vertices)};
  const auto run = [&](uint32_t frames) {
    for (uint32_t frame = 0; frame < frames; ++frame)
      ExpectSkinned(RunFrame(device_, vulkan, frame % 2, skins, vertices), 0, instance_);
  };
  run(4);
  const size_t steady = counted.out.size();
  LimberRigId next;
  ASSERT_EQ(limberLoadRig(context_, BakedTube().c_str(), nullptr, &next), LIMBER_SUCCESS);
  ASSERT_EQ(limberSwitchRig(context_, instance_, next), LIMBER_SUCCESS) << Message();
  run(1);
  EXPECT_EQ(counted.out.size(), steady + 1) << "the old rig is still there";
  ASSERT_EQ(limberDestroyRig(context_, rig_), LIMBER_SUCCESS);
  run(4);
  EXPECT_EQ(counted.out.size(), steady);
  ASSERT_EQ(limberDestroyVulkan(context_, vulkan), LIMBER_SUCCESS);
  EXPECT_TRUE(counted.out.empty());
}

TEST_F(CapiVulkan, ALostDevice_TakesNothingWithItButWhatWasOnIt) {
  viewer::DeviceOptions options;
  options.validation = true;
  auto first = viewer::VulkanDevice::Create(options);
  ASSERT_TRUE(first.ok()) << first.status().message();
  LimberVulkanDef def = DefOf(**first);
  LimberVulkanId vulkan;
  ASSERT_EQ(limberCreateVulkan(context_, &def, &vulkan), LIMBER_SUCCESS);
  const auto run = [&](viewer::VulkanDevice* device) {
    const VulkanBuffer vertices = MakeVertices(*device, info_.num_vertices);
    const auto skin = SkinInto(vertices.handle(), 0, instance_, info_.num_vertices);
    ExpectSkinned(RunFrame(device, vulkan, 0, {skin}, vertices), 0, instance_);
  };
  Move(instance_, 0.1f * info_.diagonal);
  run(first->get());
  ASSERT_EQ(limberDestroyVulkan(context_, vulkan), LIMBER_SUCCESS);
  EXPECT_EQ((*first)->validation_log().count(), 0);
  *first = nullptr;  // what it left behind, the layer would say
  auto second = viewer::VulkanDevice::Create(options);
  ASSERT_TRUE(second.ok()) << second.status().message();
  def = DefOf(**second);
  ASSERT_EQ(limberCreateVulkan(context_, &def, &vulkan), LIMBER_SUCCESS);
  Move(instance_, 0.2f * info_.diagonal);
  run(second->get());
  ASSERT_EQ(limberDestroyVulkan(context_, vulkan), LIMBER_SUCCESS);
  EXPECT_EQ((*second)->validation_log().count(), 0);
}

}  // namespace
}  // namespace limber::test
