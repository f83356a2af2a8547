// What the artist waits for: the skinning weights, and the whole bake.
#include "bake/skinning_weights.h"
#include "benchmarks/bench_character.h"
#include "geometry/bridges.h"
#include "geometry/cotangent.h"
#include "geometry/weld.h"

#include <Eigen/SparseCholesky>
#include <benchmark/benchmark.h>

#include <algorithm>

namespace limber::bench {
namespace {

struct WeightsProblem {
  geometry::SolveMesh mesh;
  std::vector<int> handle_vertices;
};

WeightsProblem MakeProblem(const bake::RawCharacter& raw) {
  WeightsProblem problem;
  problem.mesh = geometry::WeldMesh(raw.shapes, raw.triangles, 0);
  geometry::ConnectComponents(&problem.mesh);
  for (const bake::HandleSpec& spec : raw.marked_handles) {
    problem.handle_vertices.push_back(
        static_cast<int>(problem.mesh.solve_vertex[*spec.source_vertex]));
  }
  return problem;
}

// Bounded biharmonic weights on one thread.
void Weights(benchmark::State& state) {
  const WeightsProblem problem = MakeProblem(MakeRawCharacter({4000, 6, 1}));
  while (state.KeepRunning()) {
    bake::WeightsReport report;
    const auto weights =
        bake::BoundedBiharmonicWeights(problem.mesh, problem.handle_vertices, 1, {}, &report);
    ExitUnless(weights.status());
    benchmark::DoNotOptimize(weights->data());
  }
  state.counters["vertices"] = problem.mesh.num_vertices();
}

// Biharmonic weights without the bounds: the form, one factorisation and a solve for each handle.
// One step of any method that respects the bounds costs about as much.
void WeightsUnbounded(benchmark::State& state) {
  using Matrix = Eigen::SparseMatrix<double>;
  const WeightsProblem problem = MakeProblem(MakeRawCharacter({4000, 6, 1}));
  const Eigen::Index num_vertices = problem.mesh.num_vertices();
  const auto num_handles = static_cast<Eigen::Index>(problem.handle_vertices.size());
  std::vector<Eigen::Triplet<double>> kept;
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
void WholeBake(benchmark::State& state) {
  const bake::RawCharacter raw = MakeRawCharacter({4000, 6, 4});
  while (state.KeepRunning()) {
    const auto baked = bake::Bake(raw, raw.marked_handles, {}, {});
    ExitUnless(baked.status());
    benchmark::DoNotOptimize(baked->tables.mode_edges.data());
  }
  state.counters["vertices"] = raw.num_draw_vertices();
}

// The work runs on threads of the bake's own: time is counted for the whole process.
BENCHMARK(Weights)
    ->Name("weights/4k_6")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(WeightsUnbounded)->Name("weights_unbounded/4k_6")->Unit(benchmark::kMillisecond);
BENCHMARK(WholeBake)
    ->Name("bake/4k_6x4")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace limber::bench
