// How an alternation's time and memory grow with handles (H), example shapes (S) and edge groups
// (G); growth.sh draws it.
#include "benchmarks/bench_character.h"
#include "core/vector.h"
#include "solve/pose_model.h"

#include <benchmark/benchmark.h>

#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace limber::bench {
namespace {

constexpr int kPathFrames = 480;
constexpr int kVertices = 4000;

// Bytes that the program holds, 0 where the allocator does not say.
double HeldBytes() {
#ifdef __GLIBC__
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
#else
  return 0;
#endif
}

// The last size asked for, made once for all its repetitions. Only one is kept: the larger ones
// fill a good part of a machine.
struct Subject {
  CharacterSize size;
  std::shared_ptr<const PoseModel> model;
  Vector<Vector<Vec3>> path;
};

const Subject& SubjectOf(const CharacterSize& size) {
  static Subject subject;
  if (subject.model != nullptr && subject.size == size) return subject;
  subject = {};
  const auto rig = BakeCharacter(size);
  auto model = PoseModel::Create(rig);
  ExitUnless(model.status());
  subject = {size, *model, DragPath(*rig, kPathFrames)};
  return subject;
}

void Growth(benchmark::State& state, const CharacterSize& size) {
  const Subject& subject = SubjectOf(size);
  const double before = HeldBytes();
  auto pose = PoseState::Create(subject.model);
  ExitUnless(pose.status());
  state.counters["state_bytes"] = HeldBytes() - before;
  state.counters["model_bytes"] = static_cast<double>(subject.model->bytes());
  state.counters["modes"] = subject.model->num_modes;
  state.counters["groups"] = subject.model->num_groups;
  size_t frame = 0;
  for (auto _ : state) {
    ExitUnless(SetTargets(subject.path[frame++ % subject.path.size()], &*pose));
    ExitUnless(pose->Solve({}, nullptr));
  }
}

void Register(int handles, int shapes, int groups) {
  std::string name = "growth/H" + std::to_string(handles) + "_S" + std::to_string(shapes);
  if (groups > 0) name += "_G" + std::to_string(groups);
  const CharacterSize size = {kVertices, handles, shapes, groups};
  benchmark::RegisterBenchmark(name.c_str(), Growth, size)->Unit(benchmark::kMicrosecond);
}

// One of the three at a time; groups are twice the handles where none are said.
const bool kRegistered = [] {
  for (const int handles : {4, 8, 16, 32})
    Register(handles, 4, 0);
  for (const int shapes : {2, 8, 16, 32})
    Register(8, shapes, 0);
  for (const int groups : {8, 16, 32, 64})
    Register(8, 4, groups);
  Register(48, 24, 0);
  return true;
}();

}  // namespace
}  // namespace limber::bench
