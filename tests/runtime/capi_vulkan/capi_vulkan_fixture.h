// A context with a rig and an instance on a Vulkan device, for tests of limber_vulkan.h.
#pragma once

#include "limber/limber_vulkan.h"

#include "core/vector.h"
#include "runtime/capi/capi_fixture.h"
#include "runtime/skin_vulkan/test_device.h"
#include "skin_vulkan/vulkan_buffer.h"

#include <cstring>

namespace limber::test {

// As most engines have it.
struct HostVertex {
  float position[3], normal[3], tangent[4], last[3];
};

inline LimberVulkanDef DefOf(const viewer::VulkanDevice& device) {
  LimberVulkanDef def = limberDefaultVulkanDef();
  def.instance = device.instance();
  def.physical_device = device.physical_device();
  def.device = device.handle();
  def.get_instance_proc_addr = device.host().get_instance_proc_addr;
  return def;
}

// Into a buffer of HostVertex from `offset` on.
inline LimberVulkanSkinDef SkinInto(VkBuffer buffer, VkDeviceSize offset, LimberInstanceId instance,
                                    uint32_t num_vertices) {
  constexpr uint32_t kStride = sizeof(HostVertex);
  LimberVulkanSkinDef def = limberDefaultVulkanSkinDef();
  def.instance = instance;
  def.num_vertices = num_vertices;
  def.positions = {buffer, offset + offsetof(HostVertex, position), kStride};
  def.normals = {buffer, offset + offsetof(HostVertex, normal), kStride};
  def.tangents = {buffer, offset + offsetof(HostVertex, tangent), kStride};
  def.last_positions = {buffer, offset + offsetof(HostVertex, last), kStride};
  return def;
}

class CapiVulkanTest : public CapiTest {
 protected:
  void SetUp() override {
    CapiTest::SetUp();
    std::string reason;
    device_ = SharedDevice(&reason);
    if (device_ == nullptr) GTEST_SKIP() << "no Vulkan device: " << reason;
    device_->validation_log().Clear();
    const LimberVulkanDef def = DefOf(*device_);
    ASSERT_EQ(limberCreateVulkan(context_, &def, &vulkan_), LIMBER_SUCCESS) << Message();
  }

  void TearDown() override {
    CapiTest::TearDown();  // with all that is on the device
    if (device_ == nullptr) return;
    for (const std::string& message : device_->validation_log().messages())
      ADD_FAILURE() << message;
  }

  // A buffer of vertices on a device.
  static VulkanBuffer MakeVertices(const viewer::VulkanDevice& device, size_t count) {
    VulkanBuffer buffer;
    EXPECT_TRUE(buffer
                    .Create(device.api(), count * sizeof(HostVertex),
                            VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                            kDeviceMemory)
                    .ok());
    return buffer;
  }

  // Records, submits, waits and reads back.
  Vector<HostVertex> RunFrame(viewer::VulkanDevice* device, LimberVulkanId vulkan, uint32_t slot,
                              const Vector<LimberVulkanSkinDef>& skins,
                              const VulkanBuffer& vertices) {
    VulkanBuffer copy_of;
    EXPECT_TRUE(copy_of
                    .Create(device->api(), vertices.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            kReadbackMemory)
                    .ok());
    const Status status = device->SubmitAndWait([&](VkCommandBuffer commands) {
      LimberVulkanFrameDef frame = limberDefaultVulkanFrameDef();
      frame.commands = commands;
      frame.slot = slot;
      frame.reader_stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
      frame.reader_access = VK_ACCESS_TRANSFER_READ_BIT;
      EXPECT_EQ(limberRecordVulkanSkins(context_, vulkan, &frame, skins.data(),
                                        static_cast<uint32_t>(skins.size())),
                LIMBER_SUCCESS)
          << Message();
      const VkBufferCopy copy{0, 0, vertices.size()};
      vkCmdCopyBuffer(commands, vertices.handle(), copy_of.handle(), 1, &copy);
    });
    EXPECT_TRUE(status.ok()) << status.message();
    Vector<HostVertex> read(vertices.size() / sizeof(HostVertex));
    std::memcpy(read.data(), copy_of.mapped(), vertices.size());
    return read;
  }

  // Moves the first pinned handle that far along x, and solves.
  void Move(LimberInstanceId instance, float by) {
    for (int32_t h = 0; h < info_.num_handles; ++h) {
      LimberHandleInfo handle;
      ASSERT_EQ(limberGetHandleInfo(context_, rig_, h, &handle), LIMBER_SUCCESS);
      if (handle.pinned == 0) continue;
      const float to[3] = {handle.rest_position[0] + by, handle.rest_position[1],
                           handle.rest_position[2]};
      ASSERT_EQ(limberSetTarget(context_, instance, h, to), LIMBER_SUCCESS);
      break;
    }
    ASSERT_EQ(limberSolve(context_, instance, nullptr, nullptr), LIMBER_SUCCESS) << Message();
  }

  // The CPU's skin of an instance.
  Vector<HostVertex> CpuSkin(LimberInstanceId instance) {
    Vector<HostVertex> vertices(info_.num_vertices);
    LimberSkinDef def = limberDefaultSkinDef();
    def.num_vertices = info_.num_vertices;
    def.positions = {vertices[0].position, sizeof(HostVertex)};
    def.normals = {vertices[0].normal, sizeof(HostVertex)};
    def.tangents = {vertices[0].tangent, sizeof(HostVertex)};
    EXPECT_EQ(limberSkin(context_, instance, &def), LIMBER_SUCCESS) << Message();
    return vertices;
  }

  // Vertices `first` and so on are the CPU's, within what rounding explains.
  void ExpectSkinned(const Vector<HostVertex>& gpu, size_t first, LimberInstanceId instance) {
    const Vector<HostVertex> cpu = CpuSkin(instance);
    ASSERT_LE(first + cpu.size(), gpu.size());
    for (size_t i = 0; i < cpu.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(gpu[first + i].position[axis], cpu[i].position[axis], 1e-5 * info_.diagonal);
        ASSERT_NEAR(gpu[first + i].normal[axis], cpu[i].normal[axis], 1e-4);
      }
    }
  }

  viewer::VulkanDevice* device_ = nullptr;
  LimberVulkanId vulkan_ = {};
};

}  // namespace limber::test
