// What the artist waits for: the skinning weights, and the whole bake.
#include "bake/bake.h"
#include "bake/pack_tables.h"
#include "bake/resolve_handles.h"
#include "bake/skinning_weights.h"
#include "bench/paper_table.h"
#include "benchmarks/bench_character.h"
#include "core/vector.h"
#include "geometry/bridges.h"
#include "geometry/cotangent.h"
#include "geometry/weld.h"
#include "support/temporary_folder.h"

#include <Eigen/SparseCholesky>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <utility>

namespace limber::bench {
namespace {

struct WeightsProblem {
  geometry::SolveMesh mesh;
  Vector<int> handle_vertices;
};

// A character and the handles that it is baked with.
struct BakeSubject {
  bake::RawCharacter raw;
  Vector<bake::HandleSpec> handles;
};

BakeSubject Made(const CharacterSize& size) {
  BakeSubject subject;
  subject.raw = MakeRawCharacter(size);
  subject.handles = subject.raw.marked_handles;
  return subject;
}

geometry::SolveMesh SolveMeshOf(const bake::RawCharacter& raw) {
  geometry::SolveMesh mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 0);
  geometry::ConnectComponents(&mesh);
  return mesh;
}

// The paper's horse in four shapes with ten handles chosen for it; false where the data folder is
// absent, which the benchmark then says.
bool MakeHorse(benchmark::State& state, BakeSubject* subject) {
  const auto rows = PaperTable();
  const auto row = std::find_if(rows.begin(), rows.end(),
                                [](const PaperRow& r) { return std::string(r.name) == "horse"; });
  PaperRow horse = *row;
  horse.shapes = 4;
  auto character = CharacterOf(horse, test::SharedDataFolder());
  ExitUnless(character.status());
  if (!character->is_the_papers) {
    state.SkipWithError("skipped: horse/horse_ref.obj is absent (LIMBER_DATA_DIR)");
    return false;
  }
  subject->raw = std::move(character->raw);
  subject->handles = bake::ChooseHandles(subject->raw, SolveMeshOf(subject->raw), horse.handles);
  return true;
}

WeightsProblem MakeProblem(const BakeSubject& subject) {
  WeightsProblem problem;
  problem.mesh = SolveMeshOf(subject.raw);
  auto resolved = bake::ResolveHandles(subject.raw, problem.mesh, subject.handles);
  ExitUnless(resolved.status());
  for (const bake::ResolvedHandle& handle : *resolved)
    problem.handle_vertices.push_back(handle.vertex);
  return problem;
}

// Bounded biharmonic weights; num_threads as BoundedBiharmonicWeights has it.
void Weights(benchmark::State& state, const BakeSubject& subject, int num_threads) {
  const WeightsProblem problem = MakeProblem(subject);
  bake::WeightsReport report;
  while (state.KeepRunning()) {
    const auto weights = bake::BoundedBiharmonicWeights(problem.mesh, problem.handle_vertices,
                                                        num_threads, {}, &report);
    ExitUnless(weights.status());
    benchmark::DoNotOptimize(weights->data());
  }
  state.counters["vertices"] = problem.mesh.num_vertices();
  state.counters["stationarity"] = report.stationarity;
}

// Biharmonic weights without the bounds: the form, one factorisation and a solve for each handle.
// One step of any method that respects the bounds costs about as much.
void WeightsUnbounded(benchmark::State& state, const BakeSubject& subject) {
  using Matrix = Eigen::SparseMatrix<double>;
  const WeightsProblem problem = MakeProblem(subject);
  const Eigen::Index num_vertices = problem.mesh.num_vertices();
  const auto num_handles = static_cast<Eigen::Index>(problem.handle_vertices.size());
  Vector<Eigen::Triplet<double>> kept;
  Eigen::Index row = 0;
  for (int v = 0; v < num_vertices; ++v) {
    const auto& handles = problem.handle_vertices;
    if (std::find(handles.begin(), handles.end(), v) == handles.end())
      kept.emplace_back(row++, v, 1);
  }
  Matrix select(row, num_vertices);
  select.setFromTriplets(kept.begin(), kept.end());
  Eigen::MatrixXd ones = Eigen::MatrixXd::Zero(num_vertices, num_handles);
  for (Eigen::Index h = 0; h < num_handles; ++h)
    ones(problem.handle_vertices[h], h) = 1;
  while (state.KeepRunning()) {
    const Matrix laplacian = geometry::CotangentLaplacian(problem.mesh);
    const Eigen::VectorXd areas = geometry::VertexAreas(problem.mesh);
    const Matrix scaled = areas.cwiseInverse().asDiagonal() * laplacian;
    const Matrix form = laplacian * scaled;
    const Matrix select_transposed = select.transpose();
    const Matrix rows = select * form;
    const Matrix free = rows * select_transposed;
    const Eigen::SimplicialLLT<Matrix> factor(free);
    if (factor.info() != Eigen::Success) return state.SkipWithError("no factorisation");
    const Eigen::MatrixXd weights = factor.solve(-(rows * ones));
    benchmark::DoNotOptimize(weights.data());
  }
  state.counters["vertices"] = static_cast<double>(num_vertices);
}

// From the imported mesh to the tables in memory, on all cores.
void WholeBake(benchmark::State& state, const BakeSubject& subject) {
  Vector<bake::BakeTiming> timings;
  uint64_t tensor_bytes = 0;
  while (state.KeepRunning()) {
    const auto baked = bake::Bake(subject.raw, subject.handles, {}, {});
    ExitUnless(baked.status());
    timings = baked->timings;
    const auto packed = bake::PackRigTables(baked->tables, baked->local_factors);
    ExitUnless(packed.status());
    tensor_bytes = bake::NumBytes(*packed);
    benchmark::DoNotOptimize(baked->tables.mode_edges.data());
  }
  for (const bake::BakeTiming& timing : timings)
    state.counters[timing.stage] = timing.seconds;
  state.counters["vertices"] = subject.raw.num_draw_vertices();
  const auto num_targets = static_cast<double>(subject.raw.shapes.size() - 1);
  state.counters["tensor_bytes"] = static_cast<double>(tensor_bytes);
  state.counters["morph_bytes"] = 12.0 * num_targets * subject.raw.num_draw_vertices();
}

// What is measured of a subject that is made when its turn comes; time is counted for the whole
// process, since the work runs on threads of the bake's own.
template <class Make, class Measure>
void Register(const char* name, const Make& make, const Measure& measure) {
  benchmark::RegisterBenchmark(name,
                               [=](benchmark::State& state) {
                                 BakeSubject subject;
                                 if (make(state, &subject)) measure(state, subject);
                               })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

auto MakeOf(const CharacterSize& size) {
  return [size](benchmark::State&, BakeSubject* subject) {
    *subject = Made(size);
    return true;
  };
}

const bool kRegistered = [] {
  const auto weights_alone = [](benchmark::State& state, const BakeSubject& subject) {
    Weights(state, subject, 1);
  };
  const auto weights = [](benchmark::State& state, const BakeSubject& subject) {
    Weights(state, subject, 0);
  };
  Register("weights/4k_6", MakeOf({4000, 6, 1}), weights_alone);
  Register("weights_unbounded/4k_6", MakeOf({4000, 6, 1}), WeightsUnbounded);
  Register("weights/horse_10", MakeHorse, weights);
  Register("weights_unbounded/horse_10", MakeHorse, WeightsUnbounded);
  Register("bake/4k_6x4", MakeOf({4000, 6, 4}), WholeBake);
  Register("bake/horse_10", MakeHorse, WholeBake);
  Register("bake/24k_9x6", MakeOf({24000, 9, 6}), WholeBake);
  Register("bake/100k_16x8", MakeOf({100000, 16, 8}), WholeBake);
  for (const int thousands : {2, 4, 8, 16, 32, 64}) {
    const std::string name = "bake_growth/" + std::to_string(thousands) + "k_9x6";
    Register(name.c_str(), MakeOf({1000 * thousands, 9, 6}), WholeBake);
  }
  return true;
}();

}  // namespace
}  // namespace limber::bench
