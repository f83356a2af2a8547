#include "solve/pose_state_impl.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace limber {
namespace {

// Alternations that bring the other shapes' rotations to rest at creation; the first shape itself
// is exact from the start.
constexpr int kRestIterations = 30;
constexpr double kRestTolerance = 1e-9;
constexpr int kMaxIterations = 1'000'000;

// Asks the clock only where there is a budget: results depend on the time then.
class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {
    if (seconds_ > 0) start_ = Clock::now();
  }

  bool HasPassed() const {
    return seconds_ > 0 && std::chrono::duration<double>(Clock::now() - start_).count() >= seconds_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  double seconds_;
  Clock::time_point start_;
};

// scale * basis * [A | t] for every block of T^, 3x4 row-major, with A the block transposed; in the
// plane the third rig coordinate is zero and stays so. transforms: [row chunk][K][8].
template <int K>
void StoreMatrices(const RigSpace& space, const AlignedVector<double>& transforms,
                   std::vector<float>* matrices) {
  double to_mesh[3][K];
  for (size_t axis = 0; axis < 3; ++axis) {
    for (size_t c = 0; c < K; ++c)
      to_mesh[axis][c] =
          static_cast<double>(space.scale) * static_cast<double>(space.basis[3 * c + axis]);
  }
  float* matrix = matrices->data();
  for (size_t first = 0; first < matrices->size() / 12 * (K + 1); first += K + 1, matrix += 12) {
    for (size_t i = 0; i <= K; ++i) {
      const size_t row = first + i;
      const double* entries =
          transforms.data() + row / kBlockLanes * K * kBlockLanes + row % kBlockLanes;
      for (size_t axis = 0; axis < 3; ++axis) {
        double sum = 0;
        for (size_t c = 0; c < K; ++c)
          sum += to_mesh[axis][c] * entries[c * kBlockLanes];
        matrix[axis * 4 + (i < K ? i : 3)] = static_cast<float>(sum);
      }
    }
    if (K == 2) matrix[2] = matrix[6] = matrix[10] = 0;
  }
}

}  // namespace

PoseState::Impl::Impl(std::shared_ptr<const PoseModel> shared_model, PoseRoom room)
    : model(std::move(shared_model)),
      held(*model, room.grabs, room.rotations),
      alternation(MakeAlternation(*model, held)) {
  const RigTables& tables = model->rig->tables();
  matrices.resize(tables.handles.size() * tables.shape_names.size() * 12);
  ResetToRest();
}

void PoseState::Impl::ResetToRest() {
  held.Reset(*model);
  std::visit(
      [this](auto& unknowns) {
        unknowns.UsePins(*model, *model->pins);
        held.StoreTargets(unknowns.targets.data(), unknowns.turn_targets().data());
        unknowns.ResetToRest(*model);
      },
      alternation);
  PoseOptions settle;
  settle.iterations = kRestIterations;
  settle.settle_tolerance = kRestTolerance;
  settle.rotations = model->rig->tables().has_rotations;
  // Cannot fail: the options are in range and rotations are asked for only where there are any.
  (void)Solve(settle, nullptr);
}

Status PoseState::Impl::Check(const PoseOptions& options) const {
  const char* name = model->rig->name().c_str();
  if (options.iterations < 1 || options.iterations > kMaxIterations || !(options.lambda >= 0) ||
      !std::isfinite(options.lambda) || !(options.settle_tolerance >= 0) ||
      !(options.time_budget >= 0)) {
    return Error(
        StatusCode::kInvalidArgument,
        "%s: iterations %d, lambda %g, tolerance %g, time budget %g; expected at least one "
        "iteration and finite numbers of zero or more",
        name, options.iterations, static_cast<double>(options.lambda), options.settle_tolerance,
        options.time_budget);
  }
  if (options.rotations && !model->rig->tables().has_rotations) {
    return Error(StatusCode::kUnsupported,
                 "%s: baked without rotations; solve without them or bake again", name);
  }
  if (!held.holds_anything()) {
    return Error(StatusCode::kNoHandles,
                 "%s: nothing is held, so the character could be anywhere; pin a handle or grab "
                 "the skin",
                 name);
  }
  return {};
}

Status PoseState::Impl::Solve(const PoseOptions& options, PoseReport* report) {
  LIMBER_RETURN_IF_ERROR(Check(options));
  PoseReport result;
  bool pins_changed = false;
  const PinSet& pins = held.Pins(*model, &pins_changed);
  std::visit(
      [&](auto& unknowns) {
        if (pins_changed) unknowns.UsePins(*model, pins);
        held.StoreTargets(unknowns.targets.data(), unknowns.turn_targets().data());
        Alternate(options, &unknowns, &result);
        if (report != nullptr) ReportEnergy(options, &unknowns, &result);
      },
      alternation);
  StageWatch watch(options.measure_stages ? &result.stages : nullptr);
  UpdateMatrices();
  watch.Lap(&StageTimes::transforms);
  if (report != nullptr) *report = result;
  return {};
}

template <int K>
void PoseState::Impl::Alternate(const PoseOptions& options, Alternation<K>* unknowns,
                                PoseReport* report) const {
  StageTimes* const stages = options.measure_stages ? &report->stages : nullptr;
  const typename Alternation<K>::Settings settings{static_cast<double>(options.lambda),
                                                   options.rotations, options.square_roots,
                                                   options.varying_blend, stages};
  const Deadline deadline(options.time_budget);
  while (report->iterations < options.iterations && !report->settled) {
    if (report->iterations > 0 && deadline.HasPassed()) {
      report->out_of_time = true;
      break;
    }
    const auto outcome = unknowns->Run(*model, settings);
    ++report->iterations;
    report->change = outcome.change;
    report->optimality = outcome.convex.violation;
    report->optimal = outcome.convex.converged || model->num_shapes == 1;
    report->used_weights = outcome.convex.used;
    // The first alternation of a call still has last call's rotations in front of it.
    report->settled = options.settle_tolerance > 0 && report->iterations > 1 &&
                      report->change <= options.settle_tolerance;
  }
}

template <int K>
void PoseState::Impl::ReportEnergy(const PoseOptions& options, Alternation<K>* unknowns,
                                   PoseReport* report) const {
  double nearness = 0;
  const double scale = static_cast<double>(model->rig->tables().space.scale);
  const double elastic = unknowns->ElasticEnergy(*model, &nearness);
  report->elastic = scale * std::sqrt(elastic);
  report->energy = options.square_roots ? report->elastic + scale * nearness
                                        : scale * scale * (elastic + nearness);
}

void PoseState::Impl::UpdateMatrices() {
  const RigSpace& space = model->rig->tables().space;
  if (model->k == 2) {
    StoreMatrices<2>(space, std::get<Alternation<2>>(alternation).Transforms(*model), &matrices);
  } else {
    StoreMatrices<3>(space, std::get<Alternation<3>>(alternation).Transforms(*model), &matrices);
  }
}

// Eq. 6 at one point, from the matrices that skinning uses.
Vec3 PoseState::Impl::Place(const SkinPoint& point) const {
  const SkinMesh& mesh = model->rig->mesh();
  const auto shapes = static_cast<size_t>(mesh.num_shapes);
  const auto handles = static_cast<size_t>(mesh.num_handles);
  double place[3] = {};
  for (size_t corner = 0; corner < 3; ++corner) {
    const size_t vertex = point.vertices[corner];
    for (size_t i = 0; i < handles * shapes; ++i) {
      const double weight = static_cast<double>(point.weights[corner]) *
                            static_cast<double>(mesh.weights[vertex * handles + i / shapes]);
      if (weight == 0) continue;
      const Vec3 p = mesh.shape_positions[i % shapes * mesh.num_solve_vertices + vertex];
      const float* m = matrices.data() + i * 12;
      for (size_t axis = 0; axis < 3; ++axis, m += 4) {
        place[axis] += weight * (static_cast<double>(m[0]) * static_cast<double>(p.x) +
                                 static_cast<double>(m[1]) * static_cast<double>(p.y) +
                                 static_cast<double>(m[2]) * static_cast<double>(p.z) +
                                 static_cast<double>(m[3]));
      }
    }
  }
  const RigSpace& space = model->rig->tables().space;
  return {static_cast<float>(place[0] + static_cast<double>(space.origin[0])),
          static_cast<float>(place[1] + static_cast<double>(space.origin[1])),
          static_cast<float>(place[2] + static_cast<double>(space.origin[2]))};
}

}  // namespace limber
