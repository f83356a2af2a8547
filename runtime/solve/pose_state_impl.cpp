#include "solve/pose_state_impl.h"

#include "core/out_of_memory.h"
#include "core/vector.h"

#include <algorithm>
#include <chrono>
#include <cmath>

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
                   Vector<float>* matrices) {
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

std::variant<Unknowns<2>, Unknowns<3>> MakeUnknowns(const PoseModel& model, const PoseRoom& room,
                                                    const PoseWorkspaces* workspaces) {
  if (model.k == 2) return Unknowns<2>(model, room, workspaces);
  return Unknowns<3>(model, room, workspaces);
}

template <int K>
std::unique_ptr<MotionSmoother<K>> MakeSmoother(const PoseModel& model) {
  return std::make_unique<MotionSmoother<K>>(static_cast<size_t>(model.num_groups),
                                             static_cast<size_t>(model.num_shapes));
}

}  // namespace

template <int K>
Unknowns<K>::Unknowns(const PoseModel& model, const PoseRoom& room,
                      const PoseWorkspaces* workspaces) {
  if (workspaces != nullptr) {
    memory = Alternation<K>::MakeMemory(model);
    return;
  }
  const size_t pins = HeldPoints::Capacity(model, room.grabs, room.rotations);
  own = std::make_unique<Alternation<K>>(model, pins, static_cast<size_t>(room.rotations));
  alternation = own.get();
  if (room.guaranteed) guarded = std::make_unique<TrustRegion<K>>(model, pins);
  smoother = MakeSmoother<K>(model);
}

// An alternation with the character's memory in it, while a call goes on.
template <int K>
class PoseState::Impl::Lease {
 public:
  Lease(PoseWorkspaces* workspaces, Unknowns<K>* unknowns)
      : workspaces_(workspaces),
        unknowns_(*unknowns) {
    if (!unknowns_.is_lent()) return;
    lent_ = workspaces_->Take<K>();
    lent_->Exchange(&unknowns_.memory);
    unknowns_.alternation = lent_.get();
  }

  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;

  ~Lease() {
    if (lent_ == nullptr) return;
    lent_->Exchange(&unknowns_.memory);
    unknowns_.alternation = nullptr;
    workspaces_->Give(std::move(lent_));
  }

 private:
  PoseWorkspaces* workspaces_;
  Unknowns<K>& unknowns_;
  std::unique_ptr<Alternation<K>> lent_;
};

PoseState::Impl::Impl(std::shared_ptr<const PoseModel> shared_model, PoseRoom room,
                      std::shared_ptr<PoseWorkspaces> workspaces)
    : model(std::move(shared_model)),
      held(*model, room.grabs, room.rotations, workspaces != nullptr),
      workspaces_(std::move(workspaces)),
      unknowns_(MakeUnknowns(*model, room, workspaces_.get())) {
  const RigTables& tables = model->rig->tables();
  if (workspaces_ == nullptr)
    stretch_limit_ = std::make_unique<StretchLimit>(tables.handles.size());
  matrices.resize(tables.handles.size() * tables.shape_names.size() * 12);
  ResetToRest();
}

template <int K>
void PoseState::Impl::BeginAtRest(Unknowns<K>* unknowns) {
  const Lease<K> lease(workspaces_.get(), unknowns);
  Alternation<K>& alternation = *unknowns->alternation;
  alternation.UsePins(*model->pins);
  held.StoreTargets(alternation.targets.data(), alternation.turn_targets().data());
  alternation.ResetToRest(*model);
  if (unknowns->guarded != nullptr) unknowns->guarded->Forget();
}

void PoseState::Impl::ResetToRest() {
  held.Reset(*model);
  is_smoothed_ = false;
  std::visit([this](auto& unknowns) { BeginAtRest(&unknowns); }, unknowns_);
  PoseOptions settle;
  settle.iterations = kRestIterations;
  settle.settle_tolerance = kRestTolerance;
  settle.rotations = model->rig->tables().has_rotations;
  // Cannot fail: the options are in range and rotations are asked for only where there are any.
  (void)Solve(settle, nullptr);
}

Status PoseState::Impl::Check(const PoseOptions& options) const {
  const char* name = model->rig->name().c_str();
  const auto refuse = [name](StatusCode code, const char* reason) {
    return Error(code, "%s: %s", name, reason);
  };
  const double numbers[] = {static_cast<double>(options.lambda),
                            options.settle_tolerance,
                            options.time_budget,
                            options.stretch_limit,
                            options.smoothing,
                            options.time_step};
  const bool sound = std::all_of(std::begin(numbers), std::end(numbers),
                                 [](double x) { return x >= 0 && std::isfinite(x); });
  if (!sound || options.iterations < 1 || options.iterations > kMaxIterations) {
    return Error(
        StatusCode::kInvalidArgument,
        "%s: iterations %d, lambda %g, tolerance %g, time budget %g, stretch limit %g, "
        "smoothing %g, time step %g; expected at least one iteration and finite numbers of "
        "zero or more",
        name, options.iterations, numbers[0], numbers[1], numbers[2], numbers[3], numbers[4],
        numbers[5]);
  }
  const RigTables& tables = model->rig->tables();
  if (options.rotations && !tables.has_rotations) {
    return refuse(StatusCode::kUnsupported,
                  "baked without rotations; solve without them or bake again");
  }
  if (options.stretch_limit > 0 && tables.handle_reach.empty()) {
    return refuse(StatusCode::kUnsupported,
                  "baked in format version 1, which has no reach for a stretch limit; bake again");
  }
  if (!held.holds_anything()) {
    return refuse(StatusCode::kNoHandles,
                  "nothing is held, so the character could be anywhere; pin a handle or grab the "
                  "skin");
  }
  if (!options.guaranteed) return {};
  const bool has_room =
      std::visit([](const auto& unknowns) { return unknowns.guarded != nullptr; }, unknowns_);
  if (!has_room) {
    return refuse(StatusCode::kInvalidArgument,
                  "the guaranteed mode needs room; create the state with PoseRoom::guaranteed");
  }
  if (options.smoothing > 0 || !held.holds_points_exactly()) {
    return refuse(StatusCode::kUnsupported,
                  "the guaranteed mode takes points that are held exactly, and no smoothing; clear "
                  "rotations and stiffnesses, or solve plainly");
  }
  return {};
}

Status PoseState::Impl::Solve(const PoseOptions& options, PoseReport* report) {
  LIMBER_RETURN_IF_ERROR(Check(options));
  // What is lent may have to be made.
  return CatchOutOfMemory(model->rig->name(), [&]() -> Status {
    PoseReport result;
    std::visit([&](auto& unknowns) { SolveFor(options, &unknowns, &result, report != nullptr); },
               unknowns_);
    if (report != nullptr) *report = result;
    return {};
  });
}

template <int K>
void PoseState::Impl::SolveFor(const PoseOptions& options, Unknowns<K>* unknowns,
                               PoseReport* report, bool with_energy) {
  if (options.smoothing > 0 && unknowns->smoother == nullptr)
    unknowns->smoother = MakeSmoother<K>(*model);
  if (options.stretch_limit > 0 && stretch_limit_ == nullptr)
    stretch_limit_ = std::make_unique<StretchLimit>(model->rig->tables().handles.size());
  const Lease<K> lease(workspaces_.get(), unknowns);
  const Alternation<K>& alternation = *unknowns->alternation;
  if (options.smoothing > 0 && !is_smoothed_)
    unknowns->smoother->Reset(alternation.blend(), alternation.rotations());
  SetTargets(options, unknowns, report);
  Alternate(options, unknowns, report);
  if (with_energy) ReportEnergy(options, unknowns, report);
  StageWatch watch(options.measure_stages ? &report->stages : nullptr);
  Show(options, unknowns, report);
  watch.Lap(&StageTimes::transforms);
}

template <int K>
void PoseState::Impl::SetTargets(const PoseOptions& options, Unknowns<K>* unknowns,
                                 PoseReport* report) {
  Alternation<K>& alternation = *unknowns->alternation;
  bool pins_changed = false;
  const PinSet& pins = held.Pins(*model, &pins_changed);
  if (unknowns->is_lent()) {
    alternation.Resume(*model, pins);
  } else if (pins_changed) {
    alternation.UsePins(pins);
  }
  if (pins_changed && unknowns->guarded != nullptr) unknowns->guarded->Forget();
  held.StoreTargets(alternation.targets.data(), alternation.turn_targets().data());
  if (options.stretch_limit == 0) return;
  StretchLimit::Problem problem;
  problem.dimension = K;
  problem.handles = held.pinned();
  problem.reach = model->rig->tables().handle_reach.data();
  problem.num_handles = model->rig->tables().handles.size();
  problem.weights = held.weights();
  problem.limit = options.stretch_limit;
  const StretchLimit::Outcome outcome =
      stretch_limit_->Project(problem, alternation.targets.data());
  report->pairs_at_limit = outcome.pairs_at_limit;
  report->excess_stretch = outcome.is_feasible ? 0 : outcome.violation;
}

template <int K>
void PoseState::Impl::Alternate(const PoseOptions& options, Unknowns<K>* unknowns,
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
    ++report->iterations;
    BlendReport convex;
    bool has_moved = true;  // false: a step that was not taken
    if (options.guaranteed) {
      const auto outcome = unknowns->guarded->Run(*model, settings, unknowns->alternation);
      convex = outcome.convex;
      report->change = outcome.change;
      report->rejected += outcome.rejected;
      report->settled = outcome.settled;
      has_moved = outcome.accepted;
    } else {
      const auto outcome = unknowns->alternation->Run(*model, settings);
      convex = outcome.convex;
      report->change = outcome.change;
    }
    report->optimality = convex.violation;
    report->optimal = convex.converged || model->num_shapes == 1;
    report->used_weights = convex.used;
    // The first alternation of a call still has last call's rotations in front of it.
    report->settled |= has_moved && options.settle_tolerance > 0 && report->iterations > 1 &&
                       report->change <= options.settle_tolerance;
  }
}

template <int K>
void PoseState::Impl::ReportEnergy(const PoseOptions& options, Unknowns<K>* unknowns,
                                   PoseReport* report) const {
  double nearness = options.guaranteed ? unknowns->guarded->nearness() : 0;
  const double scale = static_cast<double>(model->rig->tables().space.scale);
  const double elastic = options.guaranteed
                             ? unknowns->guarded->elastic()
                             : unknowns->alternation->ElasticEnergy(*model, &nearness);
  report->elastic = scale * std::sqrt(elastic);
  report->energy = options.square_roots ? report->elastic + scale * nearness
                                        : scale * scale * (elastic + nearness);
}

// The skinning matrices of the solution, or of what follows it smoothly.
template <int K>
void PoseState::Impl::Show(const PoseOptions& options, Unknowns<K>* unknowns, PoseReport* report) {
  Alternation<K>& alternation = *unknowns->alternation;
  MotionSmoother<K>* smoother = unknowns->smoother.get();
  is_smoothed_ = options.smoothing > 0;
  report->at_rest = !is_smoothed_ || smoother->Advance(alternation.blend(), alternation.rotations(),
                                                       options.smoothing, options.time_step);
  const AlignedVector<double>* transforms = nullptr;
  if (options.guaranteed) {
    transforms = &unknowns->guarded->Transforms(*model);
  } else if (!report->at_rest) {
    transforms = &alternation.TransformsOf(*model, smoother->blend(), smoother->rotations());
  } else {
    transforms = &alternation.Transforms(*model);
  }
  StoreMatrices<K>(model->rig->tables().space, *transforms, &matrices);
}

const AlignedVector<double>& PoseState::Impl::blend() const {
  return std::visit(
      [this](const auto& unknowns) -> const AlignedVector<double>& {
        return is_smoothed_ ? unknowns.smoother->blend() : unknowns.blend();
      },
      unknowns_);
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
