// Skinning 24 thousand vertices at H 9, S 6 on one core, beside a plain loop and a plain copy.
#include "benchmarks/bench_character.h"
#include "skin/cpu_skinner.h"
#include "skin/skin_positions.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstring>

namespace limber::bench {
namespace {

constexpr CharacterSize kSize = {24000, 9, 6};

// The character somewhere along its path.
class PosedCharacter {
 public:
  PosedCharacter() : rig_(BakedCharacter(kSize)), pose_(PoseState::Create(rig_)) {
    ExitUnless(pose_.status());
    ExitUnless(SetTargets(DragPath(*rig_, 10)[3], &*pose_));
    PoseOptions options;
    options.iterations = 10;
    ExitUnless(pose_->Solve(options, nullptr));
  }

  const Rig& rig() const { return *rig_; }

  const SkinMesh& mesh() const { return rig_->mesh(); }

  SkinTransforms transforms() const { return pose_->transforms(); }

 private:
  std::shared_ptr<const Rig> rig_;
  Result<PoseState> pose_;
};

void CountVertices(const SkinMesh& mesh, benchmark::State* state) {
  state->SetItemsProcessed(state->iterations() * mesh.num_solve_vertices);
  state->counters["vertices"] = mesh.num_solve_vertices;
}

// Eq. 6 as anybody would write it, in single precision.
void SkinPlainly(const SkinMesh& mesh, const SkinTransforms& transforms, std::vector<Vec3>* out) {
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  const auto num_shapes = static_cast<size_t>(mesh.num_shapes);
  const size_t num_vertices = mesh.num_solve_vertices;
  for (size_t v = 0; v < num_vertices; ++v) {
    Vec3 q = transforms.origin;
    for (size_t h = 0; h < num_handles; ++h) {
      const float weight = mesh.weights[v * num_handles + h];
      for (size_t s = 0; s < num_shapes; ++s) {
        const float* m = &transforms.matrices[(h * num_shapes + s) * 12];
        const Vec3 p = mesh.shape_positions[s * num_vertices + v];
        q.x += weight * (m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3]);
        q.y += weight * (m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7]);
        q.z += weight * (m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]);
      }
    }
    (*out)[v] = q;
  }
}

void SkinScalar(benchmark::State& state) {
  const PosedCharacter character;
  std::vector<Vec3> positions(character.mesh().num_solve_vertices);
  while (state.KeepRunning()) {
    SkinPlainly(character.mesh(), character.transforms(), &positions);
    benchmark::DoNotOptimize(positions.data());
  }
  CountVertices(character.mesh(), &state);
}

// The same positions by the way that ships; that they are the same is checked once.
void SkinCpu(benchmark::State& state) {
  const PosedCharacter character;
  const SkinLayout layout(character.mesh());
  std::vector<Vec3> positions(character.mesh().num_solve_vertices);
  while (state.KeepRunning()) {
    ExitUnless(SkinPositions(layout, character.transforms(), positions));
    benchmark::DoNotOptimize(positions.data());
  }
  std::vector<Vec3> expected(positions.size());
  SkinPlainly(character.mesh(), character.transforms(), &expected);
  for (size_t v = 0; v < positions.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const float difference = std::abs(positions[v][axis] - expected[v][axis]);
      if (!(difference <= 1e-5f * character.rig().diagonal())) {
        return state.SkipWithError("the two ways of skinning differ");
      }
    }
  }
  CountVertices(character.mesh(), &state);
}

// Positions, normals and tangents: what skin_vulkan does.
void SkinCpuFrames(benchmark::State& state) {
  const PosedCharacter character;
  auto skinner = CpuSkinner::Create(character.mesh(), character.rig().tables().space);
  ExitUnless(skinner.status());
  while (state.KeepRunning()) {
    ExitUnless(skinner->Skin(character.transforms()));
    benchmark::DoNotOptimize(skinner->result().normals.data());
  }
  CountVertices(character.mesh(), &state);
}

// Copies all that dense skinning must read, weights and shapes: the floor that memory sets.
void SkinCopy(benchmark::State& state) {
  const auto rig = BakedCharacter(kSize);
  const SkinMesh& mesh = rig->mesh();
  const size_t weight_bytes = mesh.weights.size() * sizeof(float);
  const size_t shape_bytes = mesh.shape_positions.size() * sizeof(Vec3);
  std::vector<char> copy(weight_bytes + shape_bytes);
  while (state.KeepRunning()) {
    std::memcpy(copy.data(), mesh.weights.data(), weight_bytes);
    std::memcpy(copy.data() + weight_bytes, mesh.shape_positions.data(), shape_bytes);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(copy.size()));
  CountVertices(mesh, &state);
}

BENCHMARK(SkinCpu)->Name("skin_cpu/24k")->Unit(benchmark::kMicrosecond);
BENCHMARK(SkinCpuFrames)->Name("skin_cpu_frames/24k")->Unit(benchmark::kMicrosecond);
BENCHMARK(SkinScalar)->Name("skin_scalar/24k")->Unit(benchmark::kMicrosecond);
BENCHMARK(SkinCopy)->Name("skin_copy/24k")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace limber::bench
