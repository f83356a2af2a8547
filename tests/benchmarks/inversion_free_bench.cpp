// Inversion-free deformation at the paper's sizes: a square of 25,600 triangles whose middle is
// turned by half a turn, a bar of 10,800 tetrahedra twisted by three quarters of one. Factors are
// made and numbers laid out within the time, as for new wishes on a mesh that is known; the plain
// one is algorithm 1 with Eigen's simplicial Cholesky, assembled and factored anew in each step.
#include "deform/inversion_free/interior_point.h"
#include "deform/inversion_free/plain_solver.h"
#include "editor_tools/deform/inversion_free/made_elements.h"

#include <benchmark/benchmark.h>

namespace limber::deform {
namespace {

InversionFreeProblem<2> Quad80() {
  const TriangleMesh grid = test::MakeGrid(80);
  return test::MakeProblem(grid, test::Swirl(grid, 180 * test::kDegree),
                           HandleWeightKind::kHarmonic);
}

InversionFreeProblem<3> Bar10800() {
  const TetMesh bar = test::MakeBar(12, 12, 15);
  return test::MakeProblem(bar, test::TwistBar(bar, 270 * test::kDegree),
                           HandleWeightKind::kHarmonic);
}

template <int D>
void Tell(const FullEnergy<D>& energy, const typename SimplexMesh<D>::Positions& x,
          InversionFreeReport* report, benchmark::State* state) {
  Measure(energy, {}, x, 0, report);
  if (!report->feasible || report->num_inverted > 0) state->SkipWithError("an element is inverted");
  state->counters["steps"] = report->iterations;
  state->counters["smallest_volume"] = report->smallest_volume;
}

template <int D>
void SolveFast(benchmark::State& state, const InversionFreeProblem<D>& problem) {
  const auto energy = FullEnergy<D>::Create(problem, {});
  InteriorPoint<D> solver(*energy, InversionFreeOptions().smallest_stretch);
  typename SimplexMesh<D>::Positions x;
  InversionFreeReport report;
  for (auto _ : state) {
    if (!SolveUnconstrained(*energy, &x).ok() || !solver.Solve({}, {}, &x, &report).ok())
      state.SkipWithError("no solution");
  }
  Tell(*energy, x, &report, &state);
}

void Quad(benchmark::State& state) {
  SolveFast(state, Quad80());
}

void Bar(benchmark::State& state) {
  SolveFast(state, Bar10800());
}

void PlainBar(benchmark::State& state) {
  const auto energy = FullEnergy<3>::Create(Bar10800(), {});
  TetMesh::Positions x;
  InversionFreeReport report;
  for (auto _ : state) {
    if (!SolveUnconstrained(*energy, &x).ok() || !SolvePlainly(*energy, {}, &x, &report).ok())
      state.SkipWithError("no solution");
  }
  Tell(*energy, x, &report, &state);
}

BENCHMARK(Quad)->Name("inversion_free/quad80")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(Bar)->Name("inversion_free/bar_10800")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(PlainBar)
    ->Name("inversion_free_plain/bar_10800")
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->UseRealTime();

}  // namespace
}  // namespace limber::deform
