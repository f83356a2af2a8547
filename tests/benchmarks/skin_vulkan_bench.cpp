// Both compute passes on whatever Vulkan device there is, from recording to the end of the work.
#include "benchmarks/bench_character.h"
#include "skin_vulkan/vulkan_skinner.h"
#include "viewer/device.h"

#include <benchmark/benchmark.h>

namespace limber::bench {
namespace {

void SkinVulkan(benchmark::State& state) {
  auto made = viewer::VulkanDevice::Create({});
  if (!made.ok()) return state.SkipWithError(made.status().message().c_str());
  viewer::VulkanDevice& device = **made;
  const auto rig = BakedCharacter({24000, 9, 6});
  auto pose = PoseState::Create(rig);
  ExitUnless(pose.status());
  auto skinner = VulkanSkinner::Create(device.host(), rig->mesh(), rig->tables().space, {});
  ExitUnless(skinner.status());
  auto instance = (*skinner)->CreateInstance();
  ExitUnless(instance.status());
  ExitUnless(
      device.SubmitAndWait([&](VkCommandBuffer commands) { (*skinner)->RecordUpload(commands); }));
  (*skinner)->ReleaseStaging();
  const auto skin = [&] {
    Status recorded;
    ExitUnless(device.SubmitAndWait([&](VkCommandBuffer commands) {
      recorded = (*skinner)->Record(commands, instance->get(), 0, pose->transforms(), {});
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
