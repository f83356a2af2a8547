#include "bench/drag_path.h"

#include "core/vector.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

namespace limber::bench {
namespace {

using Clock = std::chrono::steady_clock;

// Frames before those that count: the caches fill, and the state comes onto the path.
constexpr int kWarmUpFrames = 50;

double Median(Vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

AlternationTimes Summarise(const Vector<double>& seconds, const Vector<StageTimes>& stages) {
  AlternationTimes times;
  times.median = Median(seconds);
  times.mean =
      std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size());
  for (double StageTimes::*stage : {&StageTimes::rotations, &StageTimes::nearness,
                                    &StageTimes::blend, &StageTimes::transforms}) {
    Vector<double> values;
    values.reserve(stages.size());
    for (const StageTimes& frame : stages)
      values.push_back(frame.*stage);
    times.stages.*stage = Median(std::move(values));
  }
  return times;
}

}  // namespace

Vector<Vector<Vec3>> DragPath(const Rig& rig, int num_frames) {
  const SkinMesh& mesh = rig.mesh();
  Vector<Vector<Vec3>> path(static_cast<size_t>(num_frames));
  for (int f = 0; f < num_frames; ++f) {
    const double place = static_cast<double>(f) * rig.num_shapes() / num_frames;
    const int from = static_cast<int>(place), to = (from + 1) % rig.num_shapes();
    const auto mix = static_cast<float>(place - from);
    for (int h = 0; h < rig.num_handles(); ++h) {
      const uint32_t vertex = rig.tables().handles[static_cast<size_t>(h)].vertex;
      const Vec3 a = mesh.shape_positions[size_t(from) * mesh.num_solve_vertices + vertex];
      const Vec3 b = mesh.shape_positions[size_t(to) * mesh.num_solve_vertices + vertex];
      Vec3 target;
      for (int axis = 0; axis < rig.tables().dimension; ++axis) {
        const double turn = 2 * std::numbers::pi * (1 + h % 3) * f / num_frames + h + 2 * axis;
        target[axis] =
            (1 - mix) * a[axis] + mix * b[axis] + 0.04f * static_cast<float>(std::sin(turn));
      }
      path[static_cast<size_t>(f)].push_back(rig.ToMesh(target));
    }
  }
  return path;
}

Status SetTargets(const Vector<Vec3>& targets, PoseState* pose) {
  for (size_t h = 0; h < targets.size(); ++h) {
    if (!pose->rig().tables().handles[h].pinned) continue;
    LIMBER_RETURN_IF_ERROR(pose->SetTarget(static_cast<int>(h), targets[h]));
  }
  return {};
}

Result<AlternationTimes> TimeAlternations(const std::shared_ptr<const Rig>& rig, int num_frames,
                                          const std::function<bool(double)>& progress) {
  Result<PoseState> pose = PoseState::Create(rig);
  if (!pose.ok()) return pose.status();
  const auto path = DragPath(*rig, num_frames);
  PoseOptions options;
  options.rotations = rig->tables().has_rotations;
  options.measure_stages = true;
  Vector<double> seconds;
  Vector<StageTimes> stages;
  for (int step = -kWarmUpFrames; step < num_frames; ++step) {
    const int frame = (step + kWarmUpFrames * num_frames) % num_frames;  // the path is closed
    PoseReport report;
    const Clock::time_point start = Clock::now();
    LIMBER_RETURN_IF_ERROR(SetTargets(path[static_cast<size_t>(frame)], &*pose));
    LIMBER_RETURN_IF_ERROR(pose->Solve(options, &report));
    const std::chrono::duration<double> spent = Clock::now() - start;
    if (!progress(static_cast<double>(step + kWarmUpFrames) / (num_frames + kWarmUpFrames)))
      return Error(StatusCode::kInvalidArgument, "cancelled");
    if (step < 0) continue;
    seconds.push_back(spent.count());
    stages.push_back(report.stages);
  }
  return Summarise(seconds, stages);
}

}  // namespace limber::bench
