// Both compute passes on whatever Vulkan device there is, from recording to the end of the work.
#include "benchmarks/bench_character.h"
#include "skin_vulkan/vulkan_skinner.h"
#include "viewer/device.h"

#include <benchmark/benchmark.h>

namespace limber::bench {
namespace {

// Somebody who reads what was written; who it is costs nothing.
constexpr SkinConsumer kReader = {VK_PIPELINE_STAGE_VERTEX_INPUT_BIT,
                                  VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT};

void SkinVulkan(benchmark::State& state) {
  auto made = viewer::VulkanDevice::Create({});
  if (!made.ok()) return state.SkipWithError(made.status().message().c_str());
  viewer::VulkanDevice& device = **made;
  const auto rig = BakedCharacter({24000, 9, 6});
  auto pose = PoseState::Create(rig);
  ExitUnless(pose.status());
  auto skinner = VulkanSkinner::Create(device.host(), {});
  ExitUnless(skinner.status());
  const auto skin_rig = (*skinner)->AddRig(rig->mesh(), rig->tables().space);
  ExitUnless(skin_rig.status());
  constexpr uint32_t kStride = 40;  // position, normal, tangent
  VulkanBuffer vertices;
  ExitUnless(vertices.Create(device.api(), rig->mesh().num_draw_vertices * VkDeviceSize{kStride},
                             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, kDeviceMemory));
  VulkanSkinJob job;
  job.rig = *skin_rig;
  job.transforms = pose->transforms();
  job.positions = {vertices.handle(), 0, kStride};
  job.normals = {vertices.handle(), 12, kStride};
  job.tangents = {vertices.handle(), 24, kStride};
  const auto skin = [&] {
    Status recorded;
    ExitUnless(device.SubmitAndWait([&](VkCommandBuffer commands) {
      recorded = (*skinner)->Record(commands, 0, {&job, 1}, kReader);
    }));
    ExitUnless(recorded);
  };
  skin();  // drivers compile shaders at the first use
  while (state.KeepRunning())
    skin();
  state.SetItemsProcessed(state.iterations() * rig->mesh().num_solve_vertices);
  state.counters["vertices"] = rig->mesh().num_solve_vertices;
  state.SetLabel(device.properties().deviceName);
}

// The work runs on another chip, or on the driver's threads: what counts is the clock on the wall;
// the process's own time tells what a driver on the CPU took.
BENCHMARK(SkinVulkan)
    ->Name("skin_vulkan/24k")
    ->Unit(benchmark::kMicrosecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace limber::bench
