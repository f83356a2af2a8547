// The reduced solve: one alternation a frame, warm, along a path that changes the active shapes.
#include "benchmarks/bench_character.h"
#include "skin/cpu_skinner.h"

#include <benchmark/benchmark.h>

namespace limber::bench {
namespace {

constexpr int kPathFrames = 480;

struct Character {
  const char* name;
  CharacterSize size;
};

// Sizes of the paper's table 1, and one shape alone: as-rigid-as-possible in a reduced space, the
// floor below which a frame of many shapes cannot be expected.
constexpr Character kCharacters[] = {{"face", {4000, 9, 6}},
                                     {"horse", {4000, 10, 3}},
                                     {"head", {4000, 6, 7}},
                                     {"single_shape", {4000, 10, 1, 20}},
                                     {"H32_S16", {4000, 32, 16}}};

PoseState CreatePose(const std::shared_ptr<const Rig>& rig) {
  auto pose = PoseState::Create(rig);
  ExitUnless(pose.status());
  return std::move(pose).value();
}

// Handle targets in, blend weights and skinning matrices out.
void Alternate(benchmark::State& state, const CharacterSize& size) {
  const auto rig = BakedCharacter(size);
  const auto path = DragPath(*rig, kPathFrames);
  PoseState pose = CreatePose(rig);
  size_t frame = 0;
  for (auto _ : state) {
    ExitUnless(SetTargets(path[frame++ % path.size()], &pose));
    ExitUnless(pose.Solve({}, nullptr));
  }
  state.counters["modes"] = rig->tables().num_modes;
  state.counters["groups"] = rig->num_groups();
}

// The same, and the character skinned by one core: positions, normals and tangents.
void Frame(benchmark::State& state, const CharacterSize& size) {
  const auto rig = BakedCharacter(size);
  const auto path = DragPath(*rig, kPathFrames);
  PoseState pose = CreatePose(rig);
  auto skinner = CpuSkinner::Create(rig->mesh(), rig->tables().space);
  ExitUnless(skinner.status());
  size_t frame = 0;
  for (auto _ : state) {
    ExitUnless(SetTargets(path[frame++ % path.size()], &pose));
    ExitUnless(pose.Solve({}, nullptr));
    ExitUnless(skinner->Skin(pose.transforms()));
    benchmark::DoNotOptimize(skinner->result().positions.data());
  }
  state.counters["vertices"] = rig->mesh().num_solve_vertices;
}

const bool kRegistered = [] {
  for (const Character& character : kCharacters) {
    const std::string name = character.name;
    benchmark::RegisterBenchmark(("alternation/" + name).c_str(), Alternate, character.size)
        ->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark(("frame/" + name).c_str(), Frame, character.size)
        ->Unit(benchmark::kMicrosecond);
  }
  return true;
}();

}  // namespace
}  // namespace limber::bench
