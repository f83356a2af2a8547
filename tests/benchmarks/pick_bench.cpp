// Picking on a deformed character of 24 thousand vertices.
#include "benchmarks/bench_character.h"
#include "core/vector.h"
#include "pick/picker.h"
#include "skin/cpu_skinner.h"

#include <benchmark/benchmark.h>

#include <random>

namespace limber::bench {
namespace {

// The surface at a few places along the path, one after the other.
Vector<Vector<Vec3>> DeformedSurfaces(const std::shared_ptr<const Rig>& rig) {
  auto pose = PoseState::Create(rig);
  ExitUnless(pose.status());
  auto skinner = CpuSkinner::Create(rig->mesh(), rig->tables().space);
  ExitUnless(skinner.status());
  Vector<Vector<Vec3>> surfaces;
  for (const Vector<Vec3>& targets : DragPath(*rig, 16)) {
    ExitUnless(SetTargets(targets, &*pose));
    ExitUnless(pose->Solve({}, nullptr));
    ExitUnless(skinner->SkinPositionsOnly(pose->transforms()));
    const auto positions = skinner->result().solve_positions;
    surfaces.emplace_back(positions.begin(), positions.end());
  }
  return surfaces;
}

// The structure follows the surface.
void Refit(benchmark::State& state) {
  const auto rig = BakedCharacter({24000, 9, 6});
  const auto surfaces = DeformedSurfaces(rig);
  auto picker = Picker::Create(rig->mesh(), surfaces[0]);
  ExitUnless(picker.status());
  size_t frame = 0;
  while (state.KeepRunning())
    ExitUnless(picker->Update(surfaces[frame++ % surfaces.size()]));
  state.counters["triangles"] = rig->mesh().num_triangles();
}

// Rays from all around towards the middle of the body; nearly all of them hit.
void Ray(benchmark::State& state) {
  const auto rig = BakedCharacter({24000, 9, 6});
  const auto surface = DeformedSurfaces(rig)[5];
  auto picker = Picker::Create(rig->mesh(), surface);
  ExitUnless(picker.status());
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  Vector<PickRay> rays(1024);
  for (PickRay& ray : rays) {
    const Vec3 centre = surface[random() % surface.size()];
    for (int axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = 4 * rig->diagonal() * normal(random);
      ray.direction[axis] = 0.7f * centre[axis] - ray.origin[axis];
    }
  }
  size_t i = 0;
  int64_t hits = 0;
  while (state.KeepRunning())
    hits += picker->PickSurface(rays[i++ % rays.size()]).has_value() ? 1 : 0;
  state.counters["hits"] = static_cast<double>(hits) / static_cast<double>(state.iterations());
}

BENCHMARK(Refit)->Name("pick/refit")->Unit(benchmark::kMicrosecond);
BENCHMARK(Ray)->Name("pick/ray");

}  // namespace
}  // namespace limber::bench
