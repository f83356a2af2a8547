// Skinning 24 thousand vertices at H 9, S 6 on one core, beside a plain loop and a plain copy.
//
// The dense weights have no zero at all; of four influences each vertex has its strongest four
// handles; the baked ones are what a bake gives these handles, bounded biharmonic weights.
#include "bake/skinning_weights.h"
#include "benchmarks/bench_character.h"
#include "core/vector.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "skin/cpu_skinner.h"
#include "skin/skin_positions.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

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

enum class Weights { kBaked, kDense, kFourInfluences };

// [V][H]; takes seconds, once.
const Vector<float>& BakedWeights(const Rig& rig) {
  static const Vector<float> baked = [&] {
    const bake::RawCharacter raw = MakeRawCharacter(kSize);
    geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 0);
    geometry::ConnectComponents(&mesh);
    Vector<int> handle_vertices;
    for (const RigHandle& handle : rig.tables().handles)
      handle_vertices.push_back(static_cast<int>(handle.vertex));
    bake::WeightsReport report;
    const auto weights = bake::BoundedBiharmonicWeights(mesh, handle_vertices, 0, {}, &report);
    ExitUnless(weights.status());
    Vector<float> rows;
    for (const auto& row : weights->rowwise()) {
      for (const double weight : row)
        rows.push_back(static_cast<float>(weight));
    }
    return rows;
  }();
  return baked;
}

// The character's mesh with other weights.
SkinMesh WithWeights(const Rig& rig, Weights kind) {
  SkinMesh mesh = rig.mesh();
  if (kind == Weights::kBaked) {
    mesh.weights = BakedWeights(rig);
    return mesh;
  }
  const auto num_handles = static_cast<size_t>(mesh.num_handles);
  Vector<float> sorted(num_handles);
  for (size_t v = 0; v < mesh.num_solve_vertices; ++v) {
    float* weights = mesh.weights.data() + v * num_handles;
    std::copy_n(weights, num_handles, sorted.begin());
    std::sort(sorted.rbegin(), sorted.rend());
    float sum = 0;
    for (size_t h = 0; h < num_handles; ++h) {
      if (kind == Weights::kDense) weights[h] = std::max(weights[h], 0.01f);
      if (kind == Weights::kFourInfluences && weights[h] < sorted[3]) weights[h] = 0;
      sum += weights[h];
    }
    for (size_t h = 0; h < num_handles; ++h)
      weights[h] /= sum;
  }
  return mesh;
}

// A face: the first shape and fifty expressions, each of which swells a twentieth of the mesh.
// `matrices`: the character's, changed for those shapes, all expressions a little there.
void GiveExpressions(SkinMesh* mesh, Vector<float>* matrices) {
  constexpr size_t kExpressions = 50;
  const size_t num_vertices = mesh->num_solve_vertices;
  const Vector<Vec3> rest(mesh->shape_positions.begin(),
                          mesh->shape_positions.begin() + mesh->num_solve_vertices);
  mesh->shape_positions = rest;
  for (size_t s = 0; s < kExpressions; ++s) {
    const Vec3 centre = rest[s * num_vertices / kExpressions];
    Vector<float> squared(num_vertices);
    for (size_t v = 0; v < num_vertices; ++v) {
      const float x = rest[v].x - centre.x, y = rest[v].y - centre.y, z = rest[v].z - centre.z;
      squared[v] = x * x + y * y + z * z;
    }
    Vector<float> sorted = squared;
    const auto edge = sorted.begin() + static_cast<std::ptrdiff_t>(num_vertices / 20);
    std::nth_element(sorted.begin(), edge, sorted.end());
    for (size_t v = 0; v < num_vertices; ++v) {
      const float swell = 1 + 0.1f * std::max(0.0f, 1 - squared[v] / *edge);
      mesh->shape_positions.push_back({swell * rest[v].x, swell * rest[v].y, swell * rest[v].z});
    }
  }
  Vector<float> given;
  const auto num_shapes = static_cast<size_t>(mesh->num_shapes);
  for (size_t h = 0; h < static_cast<size_t>(mesh->num_handles); ++h) {
    float sum[12] = {};
    for (size_t i = 0; i < num_shapes * 12; ++i)
      sum[i % 12] += (*matrices)[h * num_shapes * 12 + i];
    for (size_t s = 0; s <= kExpressions; ++s) {
      for (const float entry : sum)
        given.push_back((s == 0 ? 0.5f : 0.5f / kExpressions) * entry);
    }
  }
  *matrices = std::move(given);
  mesh->num_shapes = kExpressions + 1;
}

void CountVertices(const SkinMesh& mesh, benchmark::State* state) {
  const double vertices = mesh.num_solve_vertices;
  const double bytes = vertices * 4 * (mesh.num_handles + 3 * mesh.num_shapes);  // dense
  const auto rounds = static_cast<double>(state->iterations());
  state->counters["per_vertex"] = benchmark::Counter(
      rounds * vertices, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state->counters["bytes"] = benchmark::Counter(rounds * bytes, benchmark::Counter::kIsRate);
}

// Eq. 6 as anybody would write it, in single precision.
void SkinPlainly(const SkinMesh& mesh, const SkinTransforms& transforms, Vector<Vec3>* out) {
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
  const SkinMesh mesh = WithWeights(character.rig(), Weights::kDense);
  Vector<Vec3> positions(mesh.num_solve_vertices);
  while (state.KeepRunning()) {
    SkinPlainly(mesh, character.transforms(), &positions);
    benchmark::DoNotOptimize(positions.data());
  }
  CountVertices(mesh, &state);
}

// The positions by the way that ships; that they are right is checked once.
void SkinCpu(benchmark::State& state, Weights weights, bool expressions,
             const SkinKernels& kernels) {
  const PosedCharacter character;
  SkinMesh mesh = WithWeights(character.rig(), weights);
  SkinTransforms transforms = character.transforms();
  Vector<float> matrices(transforms.matrices.begin(), transforms.matrices.end());
  if (expressions) GiveExpressions(&mesh, &matrices);
  transforms.matrices = matrices;
  const SkinLayout layout(mesh);
  SkinScratch scratch;
  Vector<Vec3> positions(mesh.num_solve_vertices);
  while (state.KeepRunning()) {
    ExitUnless(SkinPositionsWith(kernels, layout, transforms, &scratch, positions));
    benchmark::DoNotOptimize(positions.data());
  }
  Vector<Vec3> expected(positions.size());
  ExitUnless(SkinPositionsReference(mesh, transforms, expected));
  for (size_t v = 0; v < positions.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const float difference = std::abs(positions[v][axis] - expected[v][axis]);
      if (!(difference <= 1e-5f * character.rig().diagonal())) {
        return state.SkipWithError("not the sum in double");
      }
    }
  }
  state.counters["handles"] = static_cast<double>(layout.num_block_handles()) / layout.num_blocks();
  state.counters["shapes"] = static_cast<double>(layout.num_block_shapes()) / layout.num_blocks();
  CountVertices(mesh, &state);
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
  Vector<char> copy(weight_bytes + shape_bytes);
  while (state.KeepRunning()) {
    std::memcpy(copy.data(), mesh.weights.data(), weight_bytes);
    std::memcpy(copy.data() + weight_bytes, mesh.shape_positions.data(), shape_bytes);
    benchmark::ClobberMemory();
  }
  CountVertices(mesh, &state);
}

// Dense weights by every instruction set that there is; the best one under the plain name as well.
bool RegisterAll() {
  const SkinKernels& best = ChooseSkinKernels();
  const auto add = [](const std::string& name, Weights weights, bool expressions,
                      const SkinKernels& kernels) {
    const auto run = [=, &kernels](benchmark::State& state) {
      SkinCpu(state, weights, expressions, kernels);
    };
    benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMicrosecond);
  };
  add("skin_cpu/24k", Weights::kDense, false, best);
  add("skin_cpu_4_influences/24k", Weights::kFourInfluences, false, best);
  add("skin_cpu_baked/24k", Weights::kBaked, false, best);
  add("skin_cpu_expressions/24k", Weights::kBaked, true, best);
  for (const SkinKernels* const* set = AvailableSkinKernels(); *set != nullptr; ++set)
    add(std::string("skin_cpu_by/") + (*set)->name, Weights::kDense, false, **set);
  return true;
}

const bool kRegistered = RegisterAll();

BENCHMARK(SkinCpuFrames)->Name("skin_cpu_frames/24k")->Unit(benchmark::kMicrosecond);
BENCHMARK(SkinScalar)->Name("skin_scalar/24k")->Unit(benchmark::kMicrosecond);
BENCHMARK(SkinCopy)->Name("skin_copy/24k")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace limber::bench
