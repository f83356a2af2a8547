// What an engine pays through limber.h: crowds on one core and two, and the interface itself.
#include "benchmarks/bench_character.h"
#include "capi/context.h"
#include "core/vector.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

namespace limber::bench {
namespace {

constexpr int kPathFrames = 480;
constexpr CharacterSize kHorse = {4000, 10, 4};
constexpr CharacterSize kFace = {4000, 9, 6};

void ExitUnlessSuccess(LimberResult result) {
  if (result != LIMBER_SUCCESS)
    ExitUnless(Status(StatusCode::kInternal, limberResultString(result)));
}

// A context with instances of one rig, each at its own place of a path.
class Crowd {
 public:
  Crowd(const CharacterSize& size, uint32_t count, int32_t num_threads) {
    LimberContextDef def = limberDefaultContextDef();
    def.num_threads = num_threads;
    ExitUnlessSuccess(limberCreateContext(&def, &context_));
    auto entry = std::make_unique<capi::RigEntry>();
    entry->rig = BakedCharacter(size);
    path_ = DragPath(*entry->rig, kPathFrames);
    for (const RigHandle& handle : entry->rig->tables().handles)
      pinned_.push_back(handle.pinned);
    capi::SlotId id;
    context_->rigs.Insert(std::move(entry), &id);
    LimberInstanceDef instance_def = limberDefaultInstanceDef();
    instance_def.skin = 0;
    instances_.resize(count);
    for (LimberInstanceId& instance : instances_)
      ExitUnlessSuccess(
          limberCreateInstance(context_, {id.index, id.generation}, &instance_def, &instance));
  }

  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  ~Crowd() { limberDestroyContext(context_); }

  void SetTargets(size_t frame) {
    for (size_t i = 0; i < instances_.size(); ++i) {
      const Vector<Vec3>& targets = path_[(frame + 37 * i) % path_.size()];
      for (size_t h = 0; h < targets.size(); ++h) {
        const float position[] = {targets[h].x, targets[h].y, targets[h].z};
        if (pinned_[h])
          ExitUnlessSuccess(limberSetTarget(context_, instances_[i], int32_t(h), position));
      }
    }
  }

  void Solve() {
    ExitUnlessSuccess(limberSolveMany(context_, instances_.data(), uint32_t(instances_.size()),
                                      nullptr, nullptr, nullptr));
  }

  // As an engine does that has one character.
  void SolveFirst() { ExitUnlessSuccess(limberSolve(context_, instances_[0], nullptr, nullptr)); }

  const Vector<Vector<Vec3>>& path() const { return path_; }

 private:
  LimberContext* context_ = nullptr;
  Vector<LimberInstanceId> instances_;
  Vector<Vector<Vec3>> path_;
  Vector<bool> pinned_;
};

// One frame of a crowd: targets in, all solved.
void SolveCrowd(benchmark::State& state, uint32_t count, int32_t num_threads) {
  Crowd crowd(kHorse, count, num_threads);
  size_t frame = 0;
  for (auto _ : state) {
    crowd.SetTargets(frame++);
    crowd.Solve();
  }
  state.counters["us_each"] = benchmark::Counter(
      1e-6 * count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Targets and limberSolve, less what the solve itself takes (PoseState, same path): frames of both
// in turns, the medians' difference in `overhead_us`.
void UpdateOverhead(benchmark::State& state, const CharacterSize& size) {
  using Clock = std::chrono::steady_clock;
  Crowd crowd(size, 1, 1);
  auto pose = PoseState::Create(BakedCharacter(size));
  ExitUnless(pose.status());
  Vector<double> whole, alone;
  size_t frame = 0;
  for (auto _ : state) {
    const auto begin = Clock::now();
    crowd.SetTargets(frame);
    crowd.SolveFirst();
    const auto middle = Clock::now();
    ExitUnless(SetTargets(crowd.path()[frame % crowd.path().size()], &*pose));
    const auto solve = Clock::now();
    ExitUnless(pose->Solve({}, nullptr));
    const auto end = Clock::now();
    whole.push_back(std::chrono::duration<double>(middle - begin).count());
    alone.push_back(std::chrono::duration<double>(end - solve).count());
    ++frame;
  }
  const auto median = [](Vector<double>* times) {
    const auto at = times->begin() + static_cast<ptrdiff_t>(times->size() / 2);
    std::nth_element(times->begin(), at, times->end());
    return 1e6 * *at;
  };
  state.counters["update_us"] = median(&whole);
  state.counters["solve_us"] = median(&alone);
  state.counters["overhead_us"] = median(&whole) - median(&alone);
}

const bool kRegistered = [] {
  const auto crowd = [](const char* name, uint32_t count, int32_t threads) {
    benchmark::RegisterBenchmark(name, SolveCrowd, count, threads)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  };
  crowd("crowd/100/1_thread", 100, 1);
  crowd("crowd/100/2_threads", 100, 2);
  crowd("crowd/1000/1_thread", 1000, 1);
  crowd("crowd/1000/2_threads", 1000, 2);
  benchmark::RegisterBenchmark("update_overhead/face", UpdateOverhead, kFace)
      ->Unit(benchmark::kMicrosecond);
  return true;
}();

}  // namespace
}  // namespace limber::bench
