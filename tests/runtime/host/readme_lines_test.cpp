// The README's lines for a Vulkan renderer, run.
#include "engine_device.h"
#include "engine_memory.h"
#include "runtime/skin_vulkan/test_device.h"

#include <gtest/gtest.h>
#include <limber/limber.h>

#include <cmath>
#include <string>

typedef struct Renderer {  // NOLINT(modernize-use-using): the lines are C
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  uint32_t frames_in_flight;
} Renderer;

#include "runtime/package/consumer/frame_vulkan.h"

namespace {

TEST(ReadmeLines, PutACharacterIntoARenderersVertexBuffer) {
  std::string reason = limber::test::PrepareVulkan();
  const auto device = reason.empty() ? engine::Device::Create(&reason) : nullptr;
  if (device == nullptr) GTEST_SKIP() << "no Vulkan device: " << reason;
  const LimberContextDef def = limberDefaultContextDef();
  LimberContext* context = nullptr;
  ASSERT_EQ(limberCreateContext(&def, &context), LIMBER_SUCCESS);
  LimberRigId rig;
  const std::string path = std::string(LIMBER_SOURCE_DIR) + "/content/baked/v2/tube.glb";
  ASSERT_EQ(limberLoadRig(context, path.c_str(), nullptr, &rig), LIMBER_SUCCESS);
  LimberRigInfo info;
  ASSERT_EQ(limberGetRigInfo(context, rig, &info), LIMBER_SUCCESS);
  LimberInstanceId character;
  ASSERT_EQ(Spawn(context, rig, &character), LIMBER_SUCCESS);
  std::vector<Vertex> cpu(info.num_vertices);
  const float target[3] = {-1.1f, 0.4f, 0.1f};
  ASSERT_EQ(Frame(context, character, 0, target, cpu.data(), info.num_vertices), LIMBER_SUCCESS);

  const Renderer renderer = {device->instance, device->physical, device->device,
                             vkGetInstanceProcAddr, 2};
  LimberVulkanId skinning;
  ASSERT_EQ(Attach(context, &renderer, &skinning), LIMBER_SUCCESS);
  engine::BufferHeap heap(*device);
  const auto vertices =
      heap.MakeMapped(info.num_vertices * sizeof(Vertex),
                      VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  auto pool_info =
      engine::Tagged<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  VkCommandPool pool = VK_NULL_HANDLE;
  ASSERT_EQ(vkCreateCommandPool(device->device, &pool_info, nullptr, &pool), VK_SUCCESS);
  auto allocate =
      engine::Tagged<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = pool;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  ASSERT_EQ(vkAllocateCommandBuffers(device->device, &allocate, &commands), VK_SUCCESS);
  const auto begin =
      engine::Tagged<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  vkBeginCommandBuffer(commands, &begin);
  EXPECT_EQ(
      RecordSkin(context, skinning, commands, 0, character, vertices.buffer, info.num_vertices),
      LIMBER_SUCCESS);
  vkEndCommandBuffer(commands);
  auto submit = engine::Tagged<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  ASSERT_EQ(vkQueueSubmit(device->queue, 1, &submit, VK_NULL_HANDLE), VK_SUCCESS);
  vkDeviceWaitIdle(device->device);
  const auto* gpu = static_cast<const Vertex*>(vertices.mapped);
  for (uint32_t v = 0; v < info.num_vertices; ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(gpu[v].position[axis], cpu[v].position[axis], 1e-5 * info.diagonal);
      ASSERT_NEAR(gpu[v].normal[axis], cpu[v].normal[axis], 1e-4);
    }
  }
  limberDestroyContext(context);
  heap.Free(vertices);
  vkDestroyCommandPool(device->device, pool, nullptr);
  for (const std::string& complaint : device->complaints)
    ADD_FAILURE() << complaint;
}

}  // namespace
