#include "skin_vulkan/vulkan_skinner.h"

#include "runtime/skin/skin_fixtures.h"
#include "runtime/skin_vulkan/test_device.h"
#include "skin/cpu_skinner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

namespace limber {
namespace {

constexpr SkinConsumer kReadBack = {VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT};

class VulkanSkinnerTest : public test::GpuTest {
 protected:
  std::unique_ptr<VulkanSkinner> Make(const test::SkinFixture& fixture,
                                      VulkanSkinnerOptions options = {}) {
    options.extra_vertex_usage =
        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    auto skinner = VulkanSkinner::Create(device_->host(), fixture.mesh, fixture.space, options);
    EXPECT_TRUE(skinner.ok()) << skinner.status().message();
    if (!skinner.ok()) return nullptr;
    const Status uploaded = device_->SubmitAndWait(
        [&](VkCommandBuffer commands) { (*skinner)->RecordUpload(commands); });
    EXPECT_TRUE(uploaded.ok());
    (*skinner)->ReleaseStaging();
    return std::move(*skinner);
  }

  // `bytes` of the instance's results from `offset`, after `before` and skinning have run.
  std::vector<std::byte> Run(VulkanSkinner* skinner, VulkanSkinInstance* instance, uint32_t frame,
                             const SkinTransforms& transforms, VkDeviceSize offset,
                             VkDeviceSize bytes, bool fill_first = false) {
    VulkanBuffer buffer;
    EXPECT_TRUE(
        buffer.Create(device_->api(), bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, kReadbackMemory)
            .ok());
    const Status status = device_->SubmitAndWait([&](VkCommandBuffer commands) {
      if (fill_first) RecordFill(commands, *instance);
      EXPECT_TRUE(skinner->Record(commands, instance, frame, transforms, kReadBack).ok());
      const VkBufferCopy copy{offset, 0, bytes};
      vkCmdCopyBuffer(commands, instance->result_buffer(), buffer.handle(), 1, &copy);
    });
    EXPECT_TRUE(status.ok()) << status.message();
    return {buffer.mapped(), buffer.mapped() + bytes};
  }

  static void RecordFill(VkCommandBuffer commands, const VulkanSkinInstance& instance) {
    vkCmdFillBuffer(commands, instance.result_buffer(), 0, VK_WHOLE_SIZE, 0xCDCDCDCD);
    auto barrier = VulkanInfo<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                         1, &barrier, 0, nullptr, 0, nullptr);
  }

  std::vector<SkinnedVertex> Skin(VulkanSkinner* skinner, VulkanSkinInstance* instance,
                                  uint32_t frame, const SkinTransforms& transforms) {
    const SkinnedVertices where = instance->vertices(frame);
    const std::vector<std::byte> bytes =
        Run(skinner, instance, frame, transforms, where.offset, where.size);
    std::vector<SkinnedVertex> vertices(bytes.size() / sizeof(SkinnedVertex));
    std::memcpy(vertices.data(), bytes.data(), bytes.size());
    return vertices;
  }

  void ExpectEqualToCpu(const test::SkinFixture& fixture, const test::SkinPose& pose,
                        const std::vector<SkinnedVertex>& gpu) {
    Result<CpuSkinner> cpu = CpuSkinner::Create(fixture.mesh, fixture.space);
    ASSERT_TRUE(cpu.ok());
    ASSERT_TRUE(cpu->Skin(pose.view()).ok());
    const DeformedMesh expected = cpu->result();
    ASSERT_EQ(gpu.size(), expected.positions.size());
    double position = 0, normal = 0, tangent = 0;
    for (size_t d = 0; d < gpu.size(); ++d) {
      for (int axis = 0; axis < 3; ++axis) {
        position = std::max(position,
                            double{std::abs(gpu[d].position[axis] - expected.positions[d][axis])});
        normal =
            std::max(normal, double{std::abs(gpu[d].normal[axis] - expected.normals[d][axis])});
        tangent = std::max(
            tangent, double{std::abs(gpu[d].tangent[axis] - expected.tangents[d].direction[axis])});
      }
      EXPECT_EQ(gpu[d].tangent[3], expected.tangents[d].handedness);
    }
    EXPECT_LT(position, 1e-5 * test::FixtureSize(fixture));
    EXPECT_LT(normal, 1e-4);
    if (!fixture.mesh.rest_tangents.empty()) {
      EXPECT_LT(tangent, 2e-4);
    }
  }
};

test::SkinPose SpherePose(const test::SkinFixture& fixture) {
  return test::MakePose(fixture, {1, 1.2f},
                        {test::RotationAffine({1, 0, 0}, 0.1, {0, 0, 0}),
                         test::RotationAffine({1, 2, 0}, 0.9, {0.4, 0.1, 0})});
}

TEST_F(VulkanSkinnerTest, CountsThatAreNoMultipleOfTheGroup_EqualTheCpu) {
  // 13 x 18 + 2 = 236 vertices of the cylinder, 20 x 12 = 240 draw and 211 solve of the sphere.
  const test::SkinFixture cylinder = test::MakeCylinderFixture(13, 17);
  ASSERT_NE(cylinder.mesh.num_draw_vertices % 64, 0u);
  auto skinner = Make(cylinder);
  ASSERT_NE(skinner, nullptr);
  auto instance = skinner->CreateInstance();
  ASSERT_TRUE(instance.ok());
  for (const double amount : {0.0, 0.4, 1.0}) {
    const test::SkinPose pose = test::CylinderPose(cylinder, amount);
    ExpectEqualToCpu(cylinder, pose, Skin(skinner.get(), instance->get(), 0, pose.view()));
  }
  const test::SkinFixture sphere = test::MakeSeamSphereFixture(19, 11);
  auto second = Make(sphere);
  ASSERT_NE(second, nullptr);
  auto ball = second->CreateInstance();
  ASSERT_TRUE(ball.ok());
  const test::SkinPose pose = SpherePose(sphere);
  ExpectEqualToCpu(sphere, pose, Skin(second.get(), ball->get(), 0, pose.view()));
}

TEST_F(VulkanSkinnerTest, StagingAndStorageMatrices_GiveTheSameBits) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(11, 9);
  const test::SkinPose pose = test::CylinderPose(fixture, 0.8);
  std::vector<std::vector<SkinnedVertex>> results;
  for (const bool other : {false, true}) {
    VulkanSkinnerOptions options;
    options.force_staging = other;
    options.force_matrices_in_storage = other;
    auto skinner = Make(fixture, options);
    ASSERT_NE(skinner, nullptr);
    EXPECT_EQ(skinner->matrices_in_storage(), other);
    auto instance = skinner->CreateInstance();
    ASSERT_TRUE(instance.ok());
    results.push_back(Skin(skinner.get(), instance->get(), 1, pose.view()));
  }
  EXPECT_EQ(
      std::memcmp(results[0].data(), results[1].data(), results[0].size() * sizeof(SkinnedVertex)),
      0);
}

TEST_F(VulkanSkinnerTest, InstancesAndSlots_DoNotDisturbEachOther) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(11, 9);
  auto skinner = Make(fixture);
  ASSERT_NE(skinner, nullptr);
  auto a = skinner->CreateInstance(), b = skinner->CreateInstance();
  ASSERT_TRUE(a.ok() && b.ok());
  const test::SkinPose poses[3] = {test::CylinderPose(fixture, 0.2),
                                   test::CylinderPose(fixture, 0.6),
                                   test::CylinderPose(fixture, 1.1)};
  Skin(skinner.get(), a->get(), 0, poses[0].view());
  Skin(skinner.get(), a->get(), 1, poses[1].view());
  Skin(skinner.get(), b->get(), 0, poses[2].view());
  // Slot 0 of the first instance again, after the others were filled.
  ExpectEqualToCpu(fixture, poses[0], Skin(skinner.get(), a->get(), 0, poses[0].view()));
  ExpectEqualToCpu(fixture, poses[2], Skin(skinner.get(), b->get(), 1, poses[2].view()));
}

TEST_F(VulkanSkinnerTest, SeamVertices_AreBitwiseEqual) {
  const test::SkinFixture fixture = test::MakeSeamSphereFixture(21, 10);
  auto skinner = Make(fixture);
  ASSERT_NE(skinner, nullptr);
  auto instance = skinner->CreateInstance();
  ASSERT_TRUE(instance.ok());
  const std::vector<SkinnedVertex> gpu =
      Skin(skinner.get(), instance->get(), 0, SpherePose(fixture).view());
  std::vector<int> first(fixture.mesh.num_solve_vertices, -1);
  int shared = 0;
  for (size_t d = 0; d < gpu.size(); ++d) {
    int& known = first[fixture.mesh.solve_vertex[d]];
    if (known < 0) {
      known = static_cast<int>(d);
      continue;
    }
    ++shared;
    const SkinnedVertex& other = gpu[static_cast<size_t>(known)];
    EXPECT_EQ(std::memcmp(gpu[d].position, other.position, sizeof(other.position)), 0);
    EXPECT_EQ(std::memcmp(gpu[d].normal, other.normal, sizeof(other.normal)), 0);
  }
  EXPECT_GE(shared, 9);
}

TEST_F(VulkanSkinnerTest, ZeroAreaAndCollapse_GiveNoNan) {
  test::SkinFixture fixture = test::MakeSeamSphereFixture(12, 7);
  fixture.mesh.triangles.insert(fixture.mesh.triangles.end(), {0, 0, 5, 7, 8, 7});
  auto skinner = Make(fixture);
  ASSERT_NE(skinner, nullptr);
  auto instance = skinner->CreateInstance();
  ASSERT_TRUE(instance.ok());
  const test::Affine nothing{};
  const test::SkinPose pose = test::MakePose(fixture, {1, 1}, {nothing, nothing});
  for (const SkinnedVertex& v : Skin(skinner.get(), instance->get(), 0, pose.view())) {
    EXPECT_NEAR(std::hypot(v.normal[0], v.normal[1], v.normal[2]), 1, 1e-5);
    EXPECT_NEAR(std::hypot(v.tangent[0], v.tangent[1], v.tangent[2]), 1, 1e-5);
  }
}

// A pose of two shapes: the first makes the frames at rest, the second is where the vertices are
// put, to the bit: rig space is mesh space, and the matrices are the identity.
test::SkinFixture WithASecondShape(test::SkinFixture fixture) {
  fixture.space = {};
  SkinMesh& mesh = fixture.mesh;
  mesh.num_shapes = 2;
  mesh.shape_positions.resize(size_t{2} * mesh.num_solve_vertices);
  std::copy_n(mesh.shape_positions.begin(), mesh.num_solve_vertices,
              mesh.shape_positions.begin() + mesh.num_solve_vertices);
  return fixture;
}

double Dot(const float* a, const float* b) {
  return double{a[0]} * b[0] + double{a[1]} * b[1] + double{a[2]} * b[2];
}

TEST_F(VulkanSkinnerTest, CharactersOfAnySize_HaveTheFramesOfTheCpu) {
  const test::SkinFixture sphere = WithASecondShape(test::MakeSeamSphereFixture(12, 7));
  const uint32_t count = sphere.mesh.num_solve_vertices;
  // Round, flat and long, each from nearly nothing to beyond what can be squared. Frames are no
  // longer made of the largest ones: both must draw that line at the same size.
  constexpr std::array<float, 3> kForms[] = {{1, 1, 1}, {1, 1e-3f, 1}, {1, 1, 300}};
  constexpr float kSizes[] = {1e-12f, 1e-6f, 1, 1e4f, 1e6f, 1e7f, 3e7f, 1e8f, 1e12f, 1e19f, 1e30f};
  for (const std::array<float, 3>& form : kForms) {
    for (const float size : kSizes) {
      test::SkinFixture fixture = sphere;
      for (uint32_t v = 0; v < count; ++v) {
        Vec3& p = fixture.mesh.shape_positions[count + v];
        for (int axis = 0; axis < 3; ++axis)
          p[axis] *= size * form[static_cast<size_t>(axis)];
      }
      auto skinner = Make(fixture);
      ASSERT_NE(skinner, nullptr);
      auto instance = skinner->CreateInstance();
      ASSERT_TRUE(instance.ok());
      const test::SkinPose pose = test::RestPose(fixture, 1);
      const auto gpu = Skin(skinner.get(), instance->get(), 0, pose.view());
      Result<CpuSkinner> cpu = CpuSkinner::Create(fixture.mesh, fixture.space);
      ASSERT_TRUE(cpu.ok());
      ASSERT_TRUE(cpu->Skin(pose.view()).ok());
      for (size_t d = 0; d < gpu.size(); ++d) {
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_NEAR(gpu[d].normal[axis], cpu->result().normals[d][axis], 1e-4)
              << size << ' ' << d;
          ASSERT_NEAR(gpu[d].tangent[axis], cpu->result().tangents[d].direction[axis], 2e-4)
              << size << ' ' << d;
        }
      }
    }
  }
}

// A mixture of coordinates, from the same sequence on every machine: all that a float can hold, or
// only such as can be squared, which crumple the surface until tangents lie along normals.
float Extreme(bool all, uint32_t* state) {
  static constexpr float kLargest = std::numeric_limits<float>::max();
  static constexpr float kSmallest = std::numeric_limits<float>::min();
  static constexpr float kValues[] = {0,     1,    0.5f,   30,    1e-3f, 1e4f,     1e-5f,
                                      1e-8f, 3e9f, 1e-20f, 1e20f, 1e15f, kLargest, kSmallest};
  *state = *state * 1664525u + 1013904223u;
  const float value = kValues[(*state >> 8) % (all ? std::size(kValues) : 7)];
  return (*state >> 24) % 2 == 0 ? value : -value;
}

TEST_F(VulkanSkinnerTest, CoordinatesOfAnySize_GiveFiniteUnitFrames) {
  const test::SkinFixture sphere = WithASecondShape(test::MakeSeamSphereFixture(40, 30));
  uint32_t state = 1;
  for (int round = 0; round < 60; ++round) {
    const bool all = round % 3 == 0;
    test::SkinFixture fixture = sphere;
    for (uint32_t v = 0; v < fixture.mesh.num_solve_vertices; ++v) {
      fixture.mesh.shape_positions[fixture.mesh.num_solve_vertices + v] = {
          Extreme(all, &state), Extreme(all, &state), Extreme(all, &state)};
    }
    auto skinner = Make(fixture);
    ASSERT_NE(skinner, nullptr);
    auto instance = skinner->CreateInstance();
    ASSERT_TRUE(instance.ok());
    for (const SkinnedVertex& v :
         Skin(skinner.get(), instance->get(), 0, test::RestPose(fixture, 1).view())) {
      ASSERT_NEAR(Dot(v.normal, v.normal), 1, 1e-5) << round;
      ASSERT_NEAR(Dot(v.tangent, v.tangent), 1, 1e-5) << round;
      ASSERT_NEAR(Dot(v.normal, v.tangent), 0, 2e-6) << round;
    }
  }
}

TEST_F(VulkanSkinnerTest, GuardBands_AreUntouched) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(13, 17);
  VulkanSkinnerOptions options;
  options.guard_bytes = 1024;
  auto skinner = Make(fixture, options);
  ASSERT_NE(skinner, nullptr);
  auto made = skinner->CreateInstance();
  ASSERT_TRUE(made.ok());
  VulkanSkinInstance* instance = made->get();
  const std::vector<std::byte> all =
      Run(skinner.get(), instance, 1, test::CylinderPose(fixture, 0.5).view(), 0,
          instance->result_size(), true);
  const SkinnedVertices used = instance->vertices(1), unused = instance->vertices(0);
  const VkDeviceSize positions_bytes = VkDeviceSize{fixture.mesh.num_solve_vertices} * 16;
  const VkDeviceSize positions_end = (used.offset - options.guard_bytes) / 256 * 256;
  const auto clean = [&](VkDeviceSize begin, VkDeviceSize end) {
    for (VkDeviceSize i = begin; i < end; ++i) {
      if (all[i] != std::byte{0xCD}) return false;
    }
    return true;
  };
  EXPECT_TRUE(clean(0, unused.offset + unused.size + options.guard_bytes)) << "slot 0 and guards";
  EXPECT_TRUE(clean(used.offset - options.guard_bytes, used.offset)) << "before the vertices";
  EXPECT_TRUE(clean(used.offset + used.size, all.size())) << "after the vertices";
  EXPECT_FALSE(clean(used.offset, used.offset + used.size)) << "nothing was written";
  EXPECT_FALSE(clean(positions_end - positions_bytes, positions_end)) << "no positions";
}

TEST_F(VulkanSkinnerTest, BadCalls_AreRefused) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(7, 5);
  auto skinner = Make(fixture);
  ASSERT_NE(skinner, nullptr);
  auto instance = skinner->CreateInstance();
  ASSERT_TRUE(instance.ok());
  test::SkinPose pose = test::RestPose(fixture);
  EXPECT_EQ(skinner->Record(VK_NULL_HANDLE, instance->get(), 2, pose.view(), {}).code(),
            StatusCode::kInvalidArgument);
  pose.matrices.pop_back();
  EXPECT_EQ(skinner->Record(VK_NULL_HANDLE, instance->get(), 0, pose.view(), {}).code(),
            StatusCode::kInvalidArgument);
  VulkanHost no_device = device_->host();
  no_device.device = VK_NULL_HANDLE;
  EXPECT_EQ(VulkanSkinner::Create(no_device, fixture.mesh, fixture.space, {}).status().code(),
            StatusCode::kInvalidArgument);
  test::SkinFixture broken = fixture;
  broken.mesh.weights.pop_back();
  EXPECT_EQ(VulkanSkinner::Create(device_->host(), broken.mesh, broken.space, {}).status().code(),
            StatusCode::kMalformed);
  VulkanSkinnerOptions none;
  none.frames_in_flight = 0;
  EXPECT_EQ(
      VulkanSkinner::Create(device_->host(), fixture.mesh, fixture.space, none).status().code(),
      StatusCode::kInvalidArgument);
}

TEST_F(VulkanSkinnerTest, TableBeyondTheStorageRange_IsRefusedByName) {
  test::SkinFixture fixture = test::MakeCubeFixture();
  const uint64_t limit = device_->properties().limits.maxStorageBufferRange;
  if (limit > (uint64_t{1} << 28)) GTEST_SKIP() << "the device's storage range is too large";
  // One solve vertex and so many shapes that the shape table just exceeds the range.
  SkinMesh& mesh = fixture.mesh;
  mesh.num_solve_vertices = 1;
  mesh.weights.resize(1);
  mesh.solve_vertex.assign(24, 0);
  mesh.num_shapes = static_cast<int32_t>(limit / 48 + 1);
  mesh.shape_positions.assign(static_cast<size_t>(mesh.num_shapes), Vec3{});
  const auto skinner = VulkanSkinner::Create(device_->host(), mesh, fixture.space, {});
  EXPECT_EQ(skinner.status().code(), StatusCode::kLimitExceeded);
}

// The net that the other tests rely on: it must catch what it is there to catch.
TEST_F(VulkanSkinnerTest, ValidationLog_CatchesAMissingBarrier) {
  const test::SkinFixture fixture = test::MakeCylinderFixture(13, 17);
  auto skinner = Make(fixture);
  ASSERT_NE(skinner, nullptr);
  auto instance = skinner->CreateInstance();
  ASSERT_TRUE(instance.ok());
  const SkinnedVertices where = (*instance)->vertices(0);
  // Read by a copy although only vertex input was promised the results.
  EXPECT_TRUE(device_
                  ->SubmitAndWait([&](VkCommandBuffer commands) {
                    EXPECT_TRUE(skinner
                                    ->Record(commands, instance->get(), 0,
                                             test::RestPose(fixture).view(), SkinConsumer{})
                                    .ok());
                    vkCmdFillBuffer(commands, where.buffer, where.offset, where.size, 0);
                  })
                  .ok());
  EXPECT_GT(device_->validation_log().count(), 0);
  ASSERT_FALSE(device_->validation_log().messages().empty());
  EXPECT_NE(device_->validation_log().messages()[0].find("SYNC-HAZARD"), std::string::npos);
  device_->validation_log().Clear();
}

}  // namespace
}  // namespace limber
