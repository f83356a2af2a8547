#include "runtime/skin_vulkan/vulkan_skin_fixture.h"

#include "core/vector.h"
#include "skin/cpu_skinner.h"

#include <algorithm>
#include <cmath>

namespace limber::test {

void SetStreams(VkBuffer buffer, VkDeviceSize offset, VulkanSkinJob* job) {
  constexpr uint32_t kStride = sizeof(SkinnedVertex);
  job->positions = {buffer, offset + offsetof(SkinnedVertex, position), kStride};
  job->normals = {buffer, offset + offsetof(SkinnedVertex, normal), kStride};
  job->tangents = {buffer, offset + offsetof(SkinnedVertex, tangent), kStride};
}

VulkanBuffer VulkanSkinTest::MakeVertices(VkDeviceSize bytes) {
  VulkanBuffer buffer;
  const Status made =
      buffer.Create(device_->api(), bytes,
                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                    kDeviceMemory);
  EXPECT_TRUE(made.ok()) << made.message();
  return buffer;
}

std::unique_ptr<VulkanSkinner> VulkanSkinTest::MakeSkinner(const VulkanSkinnerOptions& options) {
  auto skinner = VulkanSkinner::Create(device_->host(), options);
  EXPECT_TRUE(skinner.ok()) << skinner.status().message();
  return skinner.ok() ? std::move(*skinner) : nullptr;
}

const VulkanSkinRig* VulkanSkinTest::AddRig(VulkanSkinner* skinner, const SkinFixture& fixture) {
  const auto rig = skinner->AddRig(fixture.mesh, fixture.space);
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  return rig.ok() ? *rig : nullptr;
}

Vector<std::byte> VulkanSkinTest::RunFrame(VulkanSkinner* skinner, uint32_t frame,
                                           std::span<const VulkanSkinJob> jobs,
                                           const VulkanBuffer& vertices, bool fill) {
  VulkanBuffer copy_of;
  EXPECT_TRUE(copy_of
                  .Create(device_->api(), vertices.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                          kReadbackMemory)
                  .ok());
  const Status status = device_->SubmitAndWait([&](VkCommandBuffer commands) {
    if (fill) {
      vkCmdFillBuffer(commands, vertices.handle(), 0, VK_WHOLE_SIZE, 0xCDCDCDCD);
      auto barrier = VulkanInfo<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
      barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
      barrier.dstAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT;
      vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                           VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                           1, &barrier, 0, nullptr, 0, nullptr);
    }
    const Status recorded = skinner->Record(commands, frame, jobs, kReadBack);
    EXPECT_TRUE(recorded.ok()) << recorded.message();
    const VkBufferCopy copy{0, 0, vertices.size()};
    vkCmdCopyBuffer(commands, vertices.handle(), copy_of.handle(), 1, &copy);
  });
  EXPECT_TRUE(status.ok()) << status.message();
  return {copy_of.mapped(), copy_of.mapped() + vertices.size()};
}

Vector<SkinnedVertex> VulkanSkinTest::Skin(const SkinFixture& fixture, const SkinPose& pose,
                                           const VulkanSkinnerOptions& options) {
  const auto skinner = MakeSkinner(options);
  if (skinner == nullptr) return {};
  const size_t count = fixture.mesh.num_draw_vertices;
  const VulkanBuffer vertices = MakeVertices(count * sizeof(SkinnedVertex));
  VulkanSkinJob job;
  job.rig = AddRig(skinner.get(), fixture);
  job.transforms = pose.view();
  SetStreams(vertices.handle(), 0, &job);
  return ReadAs<SkinnedVertex>(RunFrame(skinner.get(), 0, {&job, 1}, vertices), 0, count);
}

void ExpectEqualToCpu(const SkinFixture& fixture, const SkinPose& pose,
                      std::span<const SkinnedVertex> gpu) {
  Result<CpuSkinner> cpu = CpuSkinner::Create(fixture.mesh, fixture.space);
  ASSERT_TRUE(cpu.ok());
  ASSERT_TRUE(cpu->Skin(pose.view()).ok());
  const DeformedMesh expected = cpu->result();
  ASSERT_EQ(gpu.size(), expected.positions.size());
  double position = 0, normal = 0, tangent = 0;
  for (size_t d = 0; d < gpu.size(); ++d) {
    for (int axis = 0; axis < 3; ++axis) {
      position =
          std::max(position, double{std::abs(gpu[d].position[axis] - expected.positions[d][axis])});
      normal = std::max(normal, double{std::abs(gpu[d].normal[axis] - expected.normals[d][axis])});
      tangent = std::max(
          tangent, double{std::abs(gpu[d].tangent[axis] - expected.tangents[d].direction[axis])});
    }
    EXPECT_EQ(gpu[d].tangent[3], expected.tangents[d].handedness);
  }
  EXPECT_LT(position, 1e-5 * FixtureSize(fixture));
  EXPECT_LT(normal, 1e-4);
  if (!fixture.mesh.rest_tangents.empty()) {
    EXPECT_LT(tangent, 2e-4);
  }
}

}  // namespace limber::test
