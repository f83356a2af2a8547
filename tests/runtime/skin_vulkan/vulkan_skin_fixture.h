// A host that skins with VulkanSkinner: vertex buffers of its own, submitted and read back.
#pragma once

#include "core/vector.h"
#include "runtime/skin/skin_fixtures.h"
#include "runtime/skin_vulkan/test_device.h"
#include "skin_vulkan/vulkan_skinner.h"

#include <gtest/gtest.h>

#include <memory>
#include <span>

namespace limber::test {

// The layout of most tests, 40 bytes.
struct SkinnedVertex {
  float position[3], normal[3], tangent[4];
};

inline constexpr SkinConsumer kReadBack = {VK_PIPELINE_STAGE_TRANSFER_BIT,
                                           VK_ACCESS_TRANSFER_READ_BIT};

// The streams of a job as SkinnedVertex from `offset` on.
void SetStreams(VkBuffer buffer, VkDeviceSize offset, VulkanSkinJob* job);

class VulkanSkinTest : public GpuTest {
 protected:
  // A buffer that can be written by shaders, filled and read back.
  VulkanBuffer MakeVertices(VkDeviceSize bytes);
  std::unique_ptr<VulkanSkinner> MakeSkinner(const VulkanSkinnerOptions& options = {});
  const VulkanSkinRig* AddRig(VulkanSkinner* skinner, const SkinFixture& fixture);

  // Records and submits one frame, waits, and copies the buffer. `fill`: with 0xCD first.
  Vector<std::byte> RunFrame(VulkanSkinner* skinner, uint32_t frame,
                             std::span<const VulkanSkinJob> jobs, const VulkanBuffer& vertices,
                             bool fill = false);
  // One character in a skinner of its own.
  Vector<SkinnedVertex> Skin(const SkinFixture& fixture, const SkinPose& pose,
                             const VulkanSkinnerOptions& options = {});
};

// Positions, normals and tangents as the CPU has them, within what rounding explains.
void ExpectEqualToCpu(const SkinFixture& fixture, const SkinPose& pose,
                      std::span<const SkinnedVertex> gpu);

template <class T>
Vector<T> ReadAs(std::span<const std::byte> bytes, size_t offset, size_t count) {
  Vector<T> values(count);
  EXPECT_LE(offset + count * sizeof(T), bytes.size());
  std::memcpy(values.data(), bytes.data() + offset, count * sizeof(T));
  return values;
}

}  // namespace limber::test
