// The convex step (eq. 20) alone, along the path of solve_bench.cpp at the size of the paper's
// `face`: ours, and Ipopt on the transforms and the blend weights both, on the same frames.
#include "benchmarks/bench_character.h"
#include "core/vector.h"
#include "runtime/convex_oracle/full_problem.h"
#include "runtime/convex_oracle/ipopt_solver.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>

namespace limber::bench {
namespace {

constexpr CharacterSize kFace = {4000, 9, 6};
constexpr size_t kPathFrames = 480;
constexpr size_t kIpoptStride = 40;  // Ipopt takes one frame of so many, and the one before it

constexpr double kIpoptTolerance = 1e-8;  // its default

using Settings = Alternation<3>::Settings;

// The character, its path in rig space, and one alternation a frame along it.
class Walk {
 public:
  Walk() : rig_(BakedCharacter(kFace)), path_(DragPath(*rig_, kPathFrames)) {
    auto model = PoseModel::Create(rig_);
    ExitUnless(model.status());
    model_ = *model;
    alternation_ = std::make_unique<Alternation<3>>(*model_);
    SetTargets(0);
    alternation_->ResetToRest(*model_);
  }

  const PoseModel& model() const { return *model_; }

  Alternation<3>& alternation() { return *alternation_; }

  // The next frame: its targets, R, D and B.
  void Step() {
    SetTargets(frame_++ % kPathFrames);
    alternation_->Run(*model_, Settings{});
  }

  double Objective() {
    return oracle::ReachedObjective<3>(*model_, Settings{}, alternation_.get());
  }

 private:
  void SetTargets(size_t frame) {
    for (size_t c = 0; c < model_->pins->size(); ++c) {
      const Vec3 x = rig_->ToRig(path_[frame][static_cast<size_t>(model_->pinned_handles[c])]);
      for (int axis = 0; axis < 3; ++axis)
        alternation_->targets[3 * c + static_cast<size_t>(axis)] = x[axis];
    }
  }

  std::shared_ptr<const Rig> rig_;
  Vector<Vector<Vec3>> path_;
  std::shared_ptr<const PoseModel> model_;
  std::unique_ptr<Alternation<3>> alternation_;
  size_t frame_ = 0;
};

double Median(Vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What Ipopt finds on every kIpoptStride-th frame; made once, both benchmarks compare with it.
struct Comparison {
  Vector<double> seconds, objective, ours;  // a frame each
  double iterations = 0;
  bool converged = true;

  double WorstGap() const {
    double worst = -1;
    for (size_t i = 0; i < ours.size(); ++i)
      worst = std::max(worst, (ours[i] - objective[i]) / objective[i]);
    return worst;
  }
};

Comparison RunIpopt(oracle::TransformUnknowns unknowns) {
  Comparison made;
  Walk walk;
  const oracle::FullProblem<3> full(walk.model(), unknowns);
  oracle::IpoptSolver ipopt(oracle::IpoptSolver::Form::kQuotient, kIpoptTolerance);
  Eigen::VectorXd last;
  for (size_t frame = 0; frame < kPathFrames; ++frame) {
    walk.Step();
    // The last frame's problem solved to the end, then this one's from there: the best start that
    // a frame can have. Only the latter counts.
    const bool is_before = frame % kIpoptStride == kIpoptStride - 2;
    const bool counts = frame % kIpoptStride == kIpoptStride - 1;
    if (!is_before && !counts) continue;
    const oracle::ConvexProblem problem = full.Make(&walk.alternation(), Settings{});
    if (is_before) last = full.Unknowns(&walk.alternation());
    const oracle::IpoptAnswer answer = ipopt.Solve(problem, last, counts);
    last = answer.x;
    if (!counts) continue;
    made.converged = made.converged && answer.converged;
    made.seconds.push_back(answer.seconds);
    made.objective.push_back(answer.objective);
    made.ours.push_back(walk.Objective());
    made.iterations += answer.iterations;
  }
  made.iterations /= static_cast<double>(made.seconds.size());
  return made;
}

const Comparison& CompareWithIpopt(oracle::TransformUnknowns unknowns) {
  static std::map<oracle::TransformUnknowns, Comparison> made;
  const auto found = made.find(unknowns);
  return found != made.end() ? found->second : made[unknowns] = RunIpopt(unknowns);
}

// Rows of A, columns of Q and the active set, from the last frame's blend weights; D and R given.
void ConvexStep(benchmark::State& state) {
  Walk walk;
  Vector<double> seconds, objective;
  double faces = 0;
  for (auto _ : state) {
    walk.Step();
    const auto before = std::chrono::steady_clock::now();
    const BlendReport report = walk.alternation().RepeatConvexStep(walk.model());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    state.SetIterationTime(took.count());
    seconds.push_back(took.count());
    objective.push_back(walk.Objective());
    faces += report.faces;
    if (!report.converged) state.SkipWithError("the convex step did not converge");
  }
  state.counters["median_us"] = 1e6 * Median(seconds);
  state.counters["objective"] = Median(objective);
  state.counters["faces"] = faces / static_cast<double>(seconds.size());
  if (oracle::IpoptSolver::IsAvailable())
    state.counters["gap"] = CompareWithIpopt(oracle::TransformUnknowns::kTransforms).WorstGap();
}

void ConvexStepIpopt(benchmark::State& state, oracle::TransformUnknowns unknowns) {
  if (!oracle::IpoptSolver::IsAvailable()) {
    state.SkipWithError("built without Ipopt (coinor-libipopt-dev)");
    return;
  }
  const Comparison& comparison = CompareWithIpopt(unknowns);
  size_t frame = 0;
  for (auto _ : state)
    state.SetIterationTime(comparison.seconds[frame++ % comparison.seconds.size()]);
  if (!comparison.converged) state.SkipWithError("Ipopt did not converge");
  state.counters["median_us"] = 1e6 * Median(comparison.seconds);
  state.counters["objective"] = Median(comparison.objective);
  state.counters["iterations"] = comparison.iterations;
  state.counters["gap"] = comparison.WorstGap();
}

BENCHMARK(ConvexStep)->Name("convex_step/face")->Unit(benchmark::kMicrosecond)->UseManualTime();
// The paper's own way, and in the coordinates that suit an optimiser best.
BENCHMARK_CAPTURE(ConvexStepIpopt, transforms, oracle::TransformUnknowns::kTransforms)
    ->Name("convex_step_ipopt/face")
    ->Unit(benchmark::kMicrosecond)
    ->UseManualTime()
    ->Iterations(kPathFrames / kIpoptStride);
BENCHMARK_CAPTURE(ConvexStepIpopt, modes, oracle::TransformUnknowns::kModes)
    ->Name("convex_step_ipopt_modes/face")
    ->Unit(benchmark::kMicrosecond)
    ->UseManualTime()
    ->Iterations(kPathFrames / kIpoptStride);

}  // namespace
}  // namespace limber::bench
