// What VulkanSkinner takes from its host: memory, functions that fail, a device that is lost.
#include "core/vector.h"
#include "runtime/skin_vulkan/vulkan_skin_fixture.h"

#include <cstring>
#include <map>

namespace limber {
namespace {

using test::SetStreams;
using test::SkinnedVertex;

// An engine's allocator: counts what is out, and can refuse.
struct HostAllocator {
  const VulkanApi* api = nullptr;
  std::map<VkBuffer, VulkanBuffer> out;
  int num_made = 0;
  VkResult refusal = VK_SUCCESS;

  static VkResult Create(void* user, const VkBufferCreateInfo& info, VkMemoryPropertyFlags required,
                         VkMemoryPropertyFlags preferred, VulkanHostBuffer* buffer) {
    auto& self = *static_cast<HostAllocator*>(user);
    if (self.refusal != VK_SUCCESS) return self.refusal;
    VulkanBuffer made;
    if (!made.Create(*self.api, info.size, info.usage, {required, preferred}).ok())
      return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    *buffer = {made.handle(), made.mapped(), &self};
    ++self.num_made;
    self.out.emplace(buffer->buffer, std::move(made));
    return VK_SUCCESS;
  }

  static void Destroy(void* user, const VulkanHostBuffer& buffer) {
    auto& self = *static_cast<HostAllocator*>(user);
    EXPECT_EQ(buffer.allocation, &self);
    EXPECT_EQ(self.out.erase(buffer.buffer), 1u);
  }
};

// Functions that stand between Limber and the device, found by name.
PFN_vkGetInstanceProcAddr real_instance_proc = nullptr;
PFN_vkGetDeviceProcAddr real_device_proc = nullptr;
int num_allocations = 0;
bool is_lost = false;

VKAPI_ATTR VkResult VKAPI_CALL CountedAllocate(VkDevice device, const VkMemoryAllocateInfo* info,
                                               const VkAllocationCallbacks* callbacks,
                                               VkDeviceMemory* memory) {
  ++num_allocations;
  if (is_lost) return VK_ERROR_DEVICE_LOST;
  return vkAllocateMemory(device, info, callbacks, memory);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL DeviceProc(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkAllocateMemory") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(CountedAllocate);
  return real_device_proc(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL InstanceProc(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(DeviceProc);
  return real_instance_proc(instance, name);
}

class VulkanHostTest : public test::VulkanSkinTest {
 protected:
  void SetUp() override {
    VulkanSkinTest::SetUp();
    if (device_ == nullptr) return;
    host_ = device_->host();
    real_instance_proc = host_.get_instance_proc_addr;
    real_device_proc = reinterpret_cast<PFN_vkGetDeviceProcAddr>(
        real_instance_proc(host_.instance, "vkGetDeviceProcAddr"));
    host_.get_instance_proc_addr = InstanceProc;
    num_allocations = 0;
    is_lost = false;
  }

  VulkanSkinJob MakeJob(VulkanSkinner* skinner, const VulkanBuffer& vertices) {
    VulkanSkinJob job;
    job.rig = AddRig(skinner, cylinder_);
    job.transforms = pose_.view();
    SetStreams(vertices.handle(), 0, &job);
    return job;
  }

  const test::SkinFixture cylinder_ = test::MakeCylinderFixture(11, 9);
  const test::SkinPose pose_ = test::CylinderPose(cylinder_, 0.6);
  const VkDeviceSize vertex_bytes_ = cylinder_.mesh.num_draw_vertices * sizeof(SkinnedVertex);
  VulkanHost host_;
};

TEST_F(VulkanHostTest, HostsAllocator_MakesAndFreesEveryBuffer) {
  HostAllocator allocator;
  allocator.api = &device_->api();
  host_.memory = {HostAllocator::Create, HostAllocator::Destroy, &allocator};
  {
    VulkanSkinnerOptions options;
    options.force_staging = true;
    auto skinner = VulkanSkinner::Create(host_, options);
    ASSERT_TRUE(skinner.ok());
    const VulkanBuffer vertices = MakeVertices(vertex_bytes_);
    const VulkanSkinJob job = MakeJob(skinner->get(), vertices);
    Vector<std::byte> bytes;
    for (uint32_t frame = 0; frame < 8; ++frame) {
      bytes = RunFrame(skinner->get(), frame % 2, {&job, 1}, vertices);
      // Rig, staging, upload of two slots, two scratches: nothing more once all were in use.
      if (frame >= 2) {
        EXPECT_EQ(allocator.num_made, 6);
      }
    }
    EXPECT_EQ(num_allocations, 0) << "memory beside the host's";
    EXPECT_EQ(allocator.out.size(), 5u) << "the staging copy should be gone";
    test::ExpectEqualToCpu(cylinder_, pose_,
                           test::ReadAs<SkinnedVertex>(bytes, 0, cylinder_.mesh.num_draw_vertices));
  }
  EXPECT_TRUE(allocator.out.empty());
}

TEST_F(VulkanHostTest, RefusedMemory_IsReportedAndTheNextFrameGoesOn) {
  HostAllocator allocator;
  allocator.api = &device_->api();
  host_.memory = {HostAllocator::Create, HostAllocator::Destroy, &allocator};
  auto skinner = VulkanSkinner::Create(host_, {});
  ASSERT_TRUE(skinner.ok());
  const VulkanBuffer vertices = MakeVertices(vertex_bytes_);
  const VulkanSkinJob job = MakeJob(skinner->get(), vertices);
  allocator.refusal = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  const Status refused = (*skinner)->Record(VK_NULL_HANDLE, 0, {&job, 1}, {});
  EXPECT_EQ(refused.code(), StatusCode::kDeviceError);
  EXPECT_NE(refused.message().find("out of device memory"), std::string::npos) << refused.message();
  EXPECT_FALSE((*skinner)->AddRig(cylinder_.mesh, cylinder_.space).ok());
  allocator.refusal = VK_SUCCESS;
  const auto bytes = RunFrame(skinner->get(), 0, {&job, 1}, vertices);
  test::ExpectEqualToCpu(cylinder_, pose_,
                         test::ReadAs<SkinnedVertex>(bytes, 0, cylinder_.mesh.num_draw_vertices));
}

TEST_F(VulkanHostTest, LostDevice_IsReportedByName) {
  auto skinner = VulkanSkinner::Create(host_, {});
  ASSERT_TRUE(skinner.ok());
  is_lost = true;
  const auto rig = (*skinner)->AddRig(cylinder_.mesh, cylinder_.space);
  EXPECT_EQ(rig.status().code(), StatusCode::kDeviceLost);
  EXPECT_NE(rig.status().message().find("device lost"), std::string::npos);
}

TEST_F(VulkanHostTest, HalfAnAllocatorOrALoaderWithoutAFunction_IsRefused) {
  host_.memory.create = HostAllocator::Create;
  EXPECT_EQ(VulkanSkinner::Create(host_, {}).status().code(), StatusCode::kInvalidArgument);
  host_.memory = {};
  host_.get_instance_proc_addr = [](VkInstance instance, const char* name) {
    return std::strcmp(name, "vkGetPhysicalDeviceProperties") == 0
               ? nullptr
               : real_instance_proc(instance, name);
  };
  const auto skinner = VulkanSkinner::Create(host_, {});
  EXPECT_EQ(skinner.status().code(), StatusCode::kDeviceError);
  EXPECT_NE(skinner.status().message().find("vkGetPhysicalDeviceProperties"), std::string::npos);
}

}  // namespace
}  // namespace limber
