// Frames, batches and vertex layouts of VulkanSkinner.
#include "core/vector.h"
#include "runtime/skin_vulkan/vulkan_skin_fixture.h"

#include <algorithm>
#include <cstring>

namespace limber {
namespace {

using test::ReadAs;
using test::SetStreams;
using test::SkinnedVertex;
using Dispatch = VulkanSkinnerOptions::Dispatch;

struct Position {
  float x, y, z;

  bool operator==(const Position&) const = default;
};

// Floats at `offset`, `stride` bytes apart, `width` of them together.
Vector<float> ReadStream(std::span<const std::byte> bytes, const VertexStream& stream, size_t count,
                         size_t width) {
  Vector<float> values;
  for (size_t i = 0; i < count; ++i) {
    const auto some = ReadAs<float>(bytes, stream.offset + i * stream.stride, width);
    values.insert(values.end(), some.begin(), some.end());
  }
  return values;
}

// Command buffers that are submitted and not waited for, until their slot comes round again.
class InFlight {
 public:
  InFlight(viewer::VulkanDevice* device, uint32_t num_slots) : device_(device), slots_(num_slots) {
    auto info =
        VulkanInfo<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    info.commandPool = device->command_pool();
    info.commandBufferCount = 1;
    for (Slot& slot : slots_) {
      EXPECT_EQ(vkAllocateCommandBuffers(device->handle(), &info, &slot.commands), VK_SUCCESS);
      auto fence = VulkanInfo<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
      fence.flags = VK_FENCE_CREATE_SIGNALED_BIT;
      EXPECT_EQ(vkCreateFence(device->handle(), &fence, nullptr, &slot.done), VK_SUCCESS);
    }
  }

  InFlight(const InFlight&) = delete;
  InFlight& operator=(const InFlight&) = delete;

  ~InFlight() {
    Wait();
    for (const Slot& slot : slots_) {
      vkDestroyFence(device_->handle(), slot.done, nullptr);
      vkFreeCommandBuffers(device_->handle(), device_->command_pool(), 1, &slot.commands);
    }
  }

  template <class Record>
  void Submit(uint32_t number, const Record& record) {
    const Slot& slot = slots_[number];
    vkWaitForFences(device_->handle(), 1, &slot.done, VK_TRUE, UINT64_MAX);
    vkResetFences(device_->handle(), 1, &slot.done);
    const auto begin =
        VulkanInfo<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    vkBeginCommandBuffer(slot.commands, &begin);
    record(slot.commands);
    vkEndCommandBuffer(slot.commands);
    auto submit = VulkanInfo<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &slot.commands;
    EXPECT_EQ(vkQueueSubmit(device_->queue(), 1, &submit, slot.done), VK_SUCCESS);
  }

  void Wait() const {
    for (const Slot& slot : slots_)
      vkWaitForFences(device_->handle(), 1, &slot.done, VK_TRUE, UINT64_MAX);
  }

 private:
  struct Slot {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence done = VK_NULL_HANDLE;
  };

  viewer::VulkanDevice* device_;
  Vector<Slot> slots_;
};

class VulkanFramesTest : public test::VulkanSkinTest {
 protected:
  void SetUp() override {
    VulkanSkinTest::SetUp();
    poses_ = {test::CylinderPose(cylinder_, 0.2), test::CylinderPose(cylinder_, 0.6),
              test::CylinderPose(cylinder_, 1.1)};
    sphere_pose_ = test::MakePose(sphere_, {1, 1.2f},
                                  {test::RotationAffine({1, 0, 0}, 0.1, {0, 0, 0}),
                                   test::RotationAffine({1, 2, 0}, 0.9, {0.4, 0.1, 0})});
  }

  const test::SkinFixture cylinder_ = test::MakeCylinderFixture(11, 9);
  const test::SkinFixture sphere_ = test::MakeSeamSphereFixture(19, 11);
  const size_t num_cylinder_ = cylinder_.mesh.num_draw_vertices;
  const size_t num_sphere_ = sphere_.mesh.num_draw_vertices;
  Vector<test::SkinPose> poses_;
  test::SkinPose sphere_pose_;
};

TEST_F(VulkanFramesTest, AnyLayout_HasTheSameNumbersAndNothingElseIsTouched) {
  const auto skinner = MakeSkinner();
  const auto packed = Skin(cylinder_, poses_[1]);
  const VulkanBuffer vertices = MakeVertices(1 << 20);
  VulkanSkinJob job;
  job.rig = AddRig(skinner.get(), cylinder_);
  job.transforms = poses_[1].view();
  // Interleaved with other things, at no alignment but a float's; tangents and last positions
  // apart.
  job.positions = {vertices.handle(), 1028, 44};
  job.normals = {vertices.handle(), 1028 + 20, 44};
  job.tangents = {vertices.handle(), 40004, 16};
  job.last_positions = {vertices.handle(), 300000, 12};
  Vector<std::byte> bytes = RunFrame(skinner.get(), 1, {&job, 1}, vertices, true);
  Vector<bool> is_ours(bytes.size(), false);
  const auto expect = [&](const VertexStream& stream, size_t offset, size_t width) {
    const Vector<float> values = ReadStream(bytes, stream, num_cylinder_, width);
    for (size_t d = 0; d < num_cylinder_; ++d) {
      EXPECT_EQ(
          std::memcmp(&values[d * width], reinterpret_cast<const std::byte*>(&packed[d]) + offset,
                      width * sizeof(float)),
          0);
      std::fill_n(is_ours.begin() + static_cast<long>(stream.offset + d * stream.stride),
                  width * sizeof(float), true);
    }
  };
  expect(job.positions, offsetof(SkinnedVertex, position), 3);
  expect(job.normals, offsetof(SkinnedVertex, normal), 3);
  expect(job.tangents, offsetof(SkinnedVertex, tangent), 4);
  expect(job.last_positions, offsetof(SkinnedVertex, position), 3);
  size_t touched = 0;
  for (size_t i = 0; i < bytes.size(); ++i) {
    if (!is_ours[i] && bytes[i] != std::byte{0xCD}) ++touched;
  }
  EXPECT_EQ(touched, 0u);
}

TEST_F(VulkanFramesTest, WhatIsNotWanted_IsNotWritten) {
  const auto skinner = MakeSkinner();
  const VulkanBuffer vertices = MakeVertices(num_cylinder_ * sizeof(SkinnedVertex));
  VulkanSkinJob job;
  job.rig = AddRig(skinner.get(), cylinder_);
  job.transforms = poses_[1].view();
  SetStreams(vertices.handle(), 0, &job);
  job.positions = job.tangents = {};
  const auto got = ReadAs<SkinnedVertex>(RunFrame(skinner.get(), 0, {&job, 1}, vertices, true), 0,
                                         num_cylinder_);
  const auto all = Skin(cylinder_, poses_[1]);
  for (size_t d = 0; d < num_cylinder_; ++d) {
    EXPECT_EQ(std::memcmp(got[d].normal, all[d].normal, sizeof(all[d].normal)), 0);
    for (const float* other : {got[d].position, got[d].tangent}) {
      uint32_t bits = 0;
      std::memcpy(&bits, other, sizeof(bits));
      EXPECT_EQ(bits, 0xCDCDCDCDu);
    }
  }
}

// What motion vectors are made of.
TEST_F(VulkanFramesTest, LastPositions_AreThoseOfTheFrameBefore) {
  const auto skinner = MakeSkinner();
  const VulkanBuffer vertices = MakeVertices(num_cylinder_ * sizeof(Position) * 4);
  VulkanSkinJob jobs[2];
  for (uint32_t i = 0; i < 2; ++i) {
    jobs[i].rig = AddRig(skinner.get(), cylinder_);
    jobs[i].instance = 7 + i;
    jobs[i].positions = {vertices.handle(), num_cylinder_ * sizeof(Position) * (2 * i), 12};
    jobs[i].last_positions = {vertices.handle(), num_cylinder_ * sizeof(Position) * (2 * i + 1),
                              12};
  }

  struct Frame {
    Vector<Position> now[2], last[2];
  };

  uint32_t number = 0;
  const auto run = [&](int a, int b, std::span<const VulkanSkinJob> which) {
    jobs[0].transforms = poses_[static_cast<size_t>(a)].view();
    jobs[0].transforms.origin.x += static_cast<float>(number);  // the space may move as well
    jobs[1].transforms = poses_[static_cast<size_t>(b)].view();
    const auto bytes = RunFrame(skinner.get(), number++ % 2, which, vertices);
    Frame frame;
    for (size_t i = 0; i < 2; ++i) {
      const size_t size = num_cylinder_ * sizeof(Position);
      frame.now[i] = ReadAs<Position>(bytes, 2 * i * size, num_cylinder_);
      frame.last[i] = ReadAs<Position>(bytes, (2 * i + 1) * size, num_cylinder_);
    }
    return frame;
  };
  const Frame first = run(0, 1, jobs);
  EXPECT_EQ(first.last[0], first.now[0]) << "there is no frame before";
  const Frame second = run(1, 2, jobs);
  EXPECT_EQ(second.last[0], first.now[0]);
  EXPECT_EQ(second.last[1], first.now[1]);
  EXPECT_NE(second.now[0], first.now[0]);
  const Frame third = run(2, 2, {&jobs[0], 1});
  EXPECT_EQ(third.last[0], second.now[0]);
  const Frame fourth = run(0, 0, jobs);
  EXPECT_EQ(fourth.last[0], third.now[0]);
  EXPECT_EQ(fourth.last[1], fourth.now[1]) << "it was not in the frame before";
  jobs[0].jumps = true;
  const Frame fifth = run(1, 1, jobs);
  EXPECT_EQ(fifth.last[0], fifth.now[0]);
  EXPECT_EQ(fifth.last[1], fourth.now[1]);
  jobs[0].jumps = false;
  jobs[0].rig = jobs[1].rig;  // as after a hot reload: other vertices
  const Frame sixth = run(2, 2, jobs);
  EXPECT_EQ(sixth.last[0], sixth.now[0]);
  EXPECT_EQ(sixth.last[1], fifth.now[1]);
}

// Cylinders and spheres, each kind's vertices after each other, from `offset` on.
Vector<VulkanSkinJob> Crowd(size_t count, const VulkanSkinRig* rig, const SkinTransforms& pose,
                            VkBuffer buffer, VkDeviceSize offset, size_t num_vertices) {
  Vector<VulkanSkinJob> jobs(count);
  for (size_t i = 0; i < count; ++i) {
    jobs[i].rig = rig;
    jobs[i].transforms = pose;
    jobs[i].instance = offset + i;
    SetStreams(buffer, offset + i * num_vertices * sizeof(SkinnedVertex), &jobs[i]);
  }
  return jobs;
}

TEST_F(VulkanFramesTest, ManyInstancesOfManyRigs_AreFewDispatchesOfTheSameBits) {
  constexpr size_t kCount = 20;
  const VkDeviceSize half = kCount * num_cylinder_ * sizeof(SkinnedVertex);
  const VulkanBuffer vertices = MakeVertices(half + kCount * num_sphere_ * sizeof(SkinnedVertex));
  Vector<Vector<std::byte>> results;
  for (const auto dispatch : {Dispatch::kOne, Dispatch::kMany}) {
    VulkanSkinnerOptions options;
    options.dispatch = dispatch;
    const auto skinner = MakeSkinner(options);
    Vector<VulkanSkinJob> jobs =
        Crowd(kCount, AddRig(skinner.get(), cylinder_), {}, vertices.handle(), 0, num_cylinder_);
    for (size_t i = 0; i < kCount; ++i)
      jobs[i].transforms = poses_[i % 3].view();
    const auto spheres = Crowd(kCount, AddRig(skinner.get(), sphere_), sphere_pose_.view(),
                               vertices.handle(), half, num_sphere_);
    jobs.insert(jobs.end(), spheres.begin(), spheres.end());
    std::reverse(jobs.begin() + 3, jobs.end());  // the order is the host's affair
    results.push_back(RunFrame(skinner.get(), 0, jobs, vertices));
    EXPECT_EQ(skinner->num_batches(), dispatch == Dispatch::kOne ? 2 * kCount : 2);
  }
  EXPECT_EQ(results[0], results[1]);
  for (size_t i = 0; i < kCount; ++i) {
    const auto one =
        ReadAs<SkinnedVertex>(results[1], i * num_cylinder_ * sizeof(SkinnedVertex), num_cylinder_);
    test::ExpectEqualToCpu(cylinder_, poses_[i % 3], one);
    const auto ball = ReadAs<SkinnedVertex>(
        results[1], half + i * num_sphere_ * sizeof(SkinnedVertex), num_sphere_);
    test::ExpectEqualToCpu(sphere_, sphere_pose_, ball);
  }
}

// Each range that is written is one dispatch's alone: else synchronization validation would see
// hazards that are none.
TEST_F(VulkanFramesTest, RigsThatTakeTurnsInABuffer_AreDispatchedApart) {
  VulkanSkinnerOptions options;
  options.dispatch = Dispatch::kMany;
  const auto skinner = MakeSkinner(options);
  const VkDeviceSize step = (num_cylinder_ + num_sphere_) * sizeof(SkinnedVertex);
  const VulkanBuffer vertices = MakeVertices(4 * step);
  Vector<VulkanSkinJob> jobs;
  const VulkanSkinRig* rigs[2] = {AddRig(skinner.get(), cylinder_), AddRig(skinner.get(), sphere_)};
  for (uint64_t i = 0; i < 8; ++i) {
    VulkanSkinJob job;
    job.rig = rigs[i % 2];
    job.instance = i;
    job.transforms = i % 2 == 0 ? poses_[0].view() : sphere_pose_.view();
    const VkDeviceSize within = i % 2 == 0 ? 0 : num_cylinder_ * sizeof(SkinnedVertex);
    SetStreams(vertices.handle(), i / 2 * step + within, &job);
    jobs.push_back(job);
  }
  const auto bytes = RunFrame(skinner.get(), 0, jobs, vertices);
  EXPECT_EQ(skinner->num_batches(), 8u);
  for (size_t i = 0; i < 4; ++i) {
    test::ExpectEqualToCpu(cylinder_, poses_[0],
                           ReadAs<SkinnedVertex>(bytes, i * step, num_cylinder_));
  }
}

TEST_F(VulkanFramesTest, CrowdsThatGrowAndShrink_AreSkinnedWhole) {
  VulkanSkinnerOptions options;
  options.frames_in_flight = 3;
  options.dispatch = Dispatch::kMany;
  const auto skinner = MakeSkinner(options);
  const VulkanSkinRig* rig = AddRig(skinner.get(), cylinder_);
  const size_t bytes = num_cylinder_ * sizeof(SkinnedVertex);
  uint32_t frame = 0;
  for (const size_t count : {1u, 2u, 40u, 3u, 1u, 90u, 0u, 5u}) {
    const VulkanBuffer vertices = MakeVertices(std::max<size_t>(1, count) * bytes);
    const auto jobs =
        Crowd(count, rig, poses_[frame % 3].view(), vertices.handle(), 0, num_cylinder_);
    const auto result = RunFrame(skinner.get(), frame % 3, jobs, vertices);
    for (size_t i = 0; i < count; i += 7) {
      test::ExpectEqualToCpu(cylinder_, poses_[frame % 3],
                             ReadAs<SkinnedVertex>(result, i * bytes, num_cylinder_));
    }
    ++frame;
  }
}

// As an engine does: each frame waits for the one before the last only. Meanwhile rigs go and the
// crowd grows, so that what the device still reads must not be freed (the validation layer looks).
TEST_F(VulkanFramesTest, FramesThatOverlapOnTheDevice_DoNotDisturbEachOther) {
  VulkanSkinnerOptions options;
  options.dispatch = Dispatch::kMany;
  const auto skinner = MakeSkinner(options);
  const VulkanSkinRig* kept = AddRig(skinner.get(), cylinder_);
  const VulkanSkinRig* other = nullptr;
  constexpr size_t kFrames = 9, kLargest = 20;
  const size_t frame_bytes = (kLargest * num_cylinder_ + num_sphere_) * sizeof(SkinnedVertex);
  VulkanBuffer vertices = MakeVertices(kFrames * frame_bytes);  // each frame its own part
  InFlight flight(device_, 2);
  for (uint32_t frame = 0; frame < kFrames; ++frame) {
    const VkDeviceSize offset = frame * frame_bytes;
    auto jobs = Crowd(1 + frame * 2, kept, poses_[frame % 3].view(), vertices.handle(), offset,
                      num_cylinder_);
    other = AddRig(skinner.get(), sphere_);
    const auto ball = Crowd(1, other, sphere_pose_.view(), vertices.handle(),
                            offset + kLargest * num_cylinder_ * sizeof(SkinnedVertex), num_sphere_);
    jobs.push_back(ball[0]);
    for (size_t i = 0; i < jobs.size(); ++i)
      jobs[i].instance = i;  // the same every frame: the last one's positions are bound
    flight.Submit(frame % 2, [&](VkCommandBuffer commands) {
      EXPECT_TRUE(skinner->Record(commands, frame % 2, jobs, test::kReadBack).ok());
    });
    skinner->RemoveRig(other);  // while the frame is on its way
  }
  flight.Wait();
  const Vector<std::byte> bytes = RunFrame(skinner.get(), 0, {}, vertices);
  for (size_t frame = 0; frame < kFrames; ++frame) {
    for (const size_t i : {size_t{0}, frame * 2}) {
      const size_t offset = frame * frame_bytes + i * num_cylinder_ * sizeof(SkinnedVertex);
      test::ExpectEqualToCpu(cylinder_, poses_[frame % 3],
                             ReadAs<SkinnedVertex>(bytes, offset, num_cylinder_));
    }
    const size_t ball = frame * frame_bytes + kLargest * num_cylinder_ * sizeof(SkinnedVertex);
    test::ExpectEqualToCpu(sphere_, sphere_pose_, ReadAs<SkinnedVertex>(bytes, ball, num_sphere_));
  }
}

TEST_F(VulkanFramesTest, RigsThatComeAndGo_LeaveTheOthersAlone) {
  const auto skinner = MakeSkinner();
  const VulkanBuffer vertices = MakeVertices(num_cylinder_ * sizeof(SkinnedVertex));
  const VulkanSkinRig* kept = AddRig(skinner.get(), cylinder_);
  skinner->RemoveRig(nullptr);
  for (uint32_t frame = 0; frame < 6; ++frame) {
    const VulkanSkinRig* other = AddRig(skinner.get(), sphere_);
    const auto jobs = Crowd(1, kept, poses_[frame % 3].view(), vertices.handle(), 0, num_cylinder_);
    const auto bytes = RunFrame(skinner.get(), frame % 2, jobs, vertices);
    test::ExpectEqualToCpu(cylinder_, poses_[frame % 3],
                           ReadAs<SkinnedVertex>(bytes, 0, num_cylinder_));
    skinner->RemoveRig(other);
  }
}

TEST_F(VulkanFramesTest, BadCalls_AreRefusedAndRecordNothing) {
  const auto skinner = MakeSkinner();
  const VulkanBuffer vertices = MakeVertices(num_cylinder_ * sizeof(SkinnedVertex));
  VulkanSkinJob good;
  good.rig = AddRig(skinner.get(), cylinder_);
  good.transforms = poses_[0].view();
  SetStreams(vertices.handle(), 0, &good);
  // No command buffer: whoever recorded would crash.
  const auto code = [&](const VulkanSkinJob& job, uint32_t frame) {
    const VulkanSkinJob jobs[2] = {good, job};
    return skinner->Record(VK_NULL_HANDLE, frame, jobs, {}).code();
  };
  EXPECT_EQ(code(good, 2), StatusCode::kInvalidArgument);
  VulkanSkinJob bad = good;
  bad.rig = nullptr;
  EXPECT_EQ(code(bad, 0), StatusCode::kInvalidArgument);
  bad = good;
  bad.transforms.matrices = bad.transforms.matrices.subspan(1);
  EXPECT_EQ(code(bad, 0), StatusCode::kInvalidArgument);
  bad = good;
  bad.tangents.stride = 12;
  EXPECT_EQ(code(bad, 0), StatusCode::kInvalidArgument);
  bad = good;
  bad.normals.offset = 6;
  EXPECT_EQ(code(bad, 0), StatusCode::kInvalidArgument);
  bad = good;
  bad.positions.stride = 1u << 31;
  EXPECT_EQ(code(bad, 0), StatusCode::kLimitExceeded);
  for (const uint32_t frames : {0u, 17u}) {
    VulkanSkinnerOptions options;
    options.frames_in_flight = frames;
    EXPECT_EQ(VulkanSkinner::Create(device_->host(), options).status().code(),
              StatusCode::kInvalidArgument);
  }
  VulkanHost no_device = device_->host();
  no_device.device = VK_NULL_HANDLE;
  EXPECT_EQ(VulkanSkinner::Create(no_device, {}).status().code(), StatusCode::kInvalidArgument);
  test::SkinFixture broken = cylinder_;
  broken.mesh.weights.pop_back();
  EXPECT_EQ(skinner->AddRig(broken.mesh, broken.space).status().code(), StatusCode::kMalformed);
}

// The net that the other tests rely on: it must catch what it is there to catch.
TEST_F(VulkanFramesTest, ValidationLog_CatchesAMissingBarrier) {
  const auto skinner = MakeSkinner();
  const VulkanBuffer vertices = MakeVertices(num_cylinder_ * sizeof(SkinnedVertex));
  VulkanSkinJob job;
  job.rig = AddRig(skinner.get(), cylinder_);
  job.transforms = poses_[0].view();
  SetStreams(vertices.handle(), 0, &job);
  // Written by a fill although only vertex input was promised the results.
  EXPECT_TRUE(device_
                  ->SubmitAndWait([&](VkCommandBuffer commands) {
                    EXPECT_TRUE(skinner->Record(commands, 0, {&job, 1}, SkinConsumer{}).ok());
                    vkCmdFillBuffer(commands, vertices.handle(), 0, VK_WHOLE_SIZE, 0);
                  })
                  .ok());
  EXPECT_GT(device_->validation_log().count(), 0);
  ASSERT_FALSE(device_->validation_log().messages().empty());
  EXPECT_NE(device_->validation_log().messages()[0].find("SYNC-HAZARD"), std::string::npos);
  device_->validation_log().Clear();
}

}  // namespace
}  // namespace limber
