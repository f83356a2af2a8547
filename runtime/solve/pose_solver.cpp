#include "solve/pose_solver.h"

#include "core/out_of_memory.h"
#include "solve/alternation.h"
#include "solve/pose_model.h"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

namespace limber {
namespace {

// Alternations that bring the other shapes' rotations to rest at creation; the first shape itself
// is exact from the start.
constexpr int kRestIterations = 30;
constexpr double kRestTolerance = 1e-9;
constexpr int kMaxIterations = 1'000'000;
constexpr float kFarthestTarget = 1e6f;  // rig units: sizes of the character

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

class PoseState::Impl {
 public:
  explicit Impl(std::shared_ptr<const PoseModel> model);

  Status SetTarget(int handle, Vec3 position);
  void ResetToRest();
  Status Solve(const PoseOptions& options, PoseReport* report);
  void UpdateMatrices();

  std::shared_ptr<const PoseModel> model;
  std::vector<Vec3> targets;    // [H], mesh space, as set
  std::vector<float> matrices;  // [H][S][3][4]
  std::variant<Alternation<2>, Alternation<3>> alternation;

 private:
  static std::variant<Alternation<2>, Alternation<3>> MakeAlternation(const PoseModel& model) {
    if (model.k == 2) return Alternation<2>(model);
    return Alternation<3>(model);
  }

  void StoreTarget(int handle, Vec3 position);
};

PoseState::Impl::Impl(std::shared_ptr<const PoseModel> shared_model)
    : model(std::move(shared_model)),
      alternation(MakeAlternation(*model)) {
  const RigTables& tables = model->rig->tables();
  targets.resize(tables.handles.size());
  matrices.resize(tables.handles.size() * tables.shape_names.size() * 12);
  ResetToRest();
}

void PoseState::Impl::StoreTarget(int handle, Vec3 position) {
  targets[static_cast<size_t>(handle)] = position;
  const int pin = model->pin_of_handle[static_cast<size_t>(handle)];
  if (pin < 0) return;
  // In double: a target far from the origin keeps its digits until it is centred.
  const RigSpace& space = model->rig->tables().space;
  double rig_position[3];
  for (int axis = 0; axis < 3; ++axis) {
    double turned = 0;
    for (int a = 0; a < 3; ++a) {
      turned += static_cast<double>(space.basis[3 * axis + a]) *
                (static_cast<double>(position[a]) - static_cast<double>(space.origin[a]));
    }
    rig_position[axis] = turned / static_cast<double>(space.scale);
  }
  std::visit(
      [&](auto& unknowns) {
        double* target = unknowns.targets.data() + ptrdiff_t{pin} * model->k;
        std::copy_n(rig_position, model->k, target);
      },
      alternation);
}

Status PoseState::Impl::SetTarget(int handle, Vec3 position) {
  if (handle < 0 || handle >= static_cast<int>(targets.size())) {
    return Error(StatusCode::kInvalidArgument, "%s: handle %d; expected 0 to %zu",
                 model->rig->name().c_str(), handle, targets.size() - 1);
  }
  const RigHandle& rig_handle = model->rig->tables().handles[static_cast<size_t>(handle)];
  if (model->pin_of_handle[static_cast<size_t>(handle)] < 0) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: handle '%s' is free and takes no target; bake it as pinned",
                 model->rig->name().c_str(), rig_handle.name.c_str());
  }
  if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: handle '%s': target (%g, %g, %g) is not finite; the old one is kept",
                 model->rig->name().c_str(), rig_handle.name.c_str(),
                 static_cast<double>(position.x), static_cast<double>(position.y),
                 static_cast<double>(position.z));
  }
  const Vec3 local = model->rig->ToRig(position);
  const float largest = std::max({std::abs(local.x), std::abs(local.y), std::abs(local.z)});
  if (!(largest <= kFarthestTarget)) {
    return Error(
        StatusCode::kInvalidArgument,
        "%s: handle '%s': target (%g, %g, %g) is over a million times the character's size "
        "away; the old one is kept",
        model->rig->name().c_str(), rig_handle.name.c_str(), static_cast<double>(position.x),
        static_cast<double>(position.y), static_cast<double>(position.z));
  }
  StoreTarget(handle, position);
  return {};
}

void PoseState::Impl::ResetToRest() {
  const std::vector<RigHandle>& handles = model->rig->tables().handles;
  for (size_t h = 0; h < handles.size(); ++h) {
    StoreTarget(static_cast<int>(h), handles[h].rest_position);
  }
  std::visit([this](auto& unknowns) { unknowns.ResetToRest(*model); }, alternation);
  PoseOptions settle;
  settle.iterations = kRestIterations;
  settle.settle_tolerance = kRestTolerance;
  settle.rotations = model->rig->tables().has_rotations;
  // Cannot fail: the options are in range and rotations are asked for only where there are any.
  (void)Solve(settle, nullptr);
}

Status PoseState::Impl::Solve(const PoseOptions& options, PoseReport* report) {
  if (options.iterations < 1 || options.iterations > kMaxIterations || !(options.lambda >= 0) ||
      !std::isfinite(options.lambda) || !(options.settle_tolerance >= 0)) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: iterations %d, lambda %g, tolerance %g; expected at least one iteration and "
                 "finite numbers of zero or more",
                 model->rig->name().c_str(), options.iterations,
                 static_cast<double>(options.lambda), options.settle_tolerance);
  }
  if (options.rotations && !model->rig->tables().has_rotations) {
    return Error(StatusCode::kUnsupported,
                 "%s: baked without rotations; solve without them or bake again",
                 model->rig->name().c_str());
  }
  PoseReport result;
  StageTimes* const stages = options.measure_stages ? &result.stages : nullptr;
  std::visit(
      [&](auto& unknowns) {
        while (result.iterations < options.iterations && !result.settled) {
          const auto outcome =
              unknowns.Run(*model, {static_cast<double>(options.lambda), options.rotations,
                                    options.square_roots, options.varying_blend, stages});
          ++result.iterations;
          result.change = outcome.change;
          result.optimality = outcome.convex.violation;
          result.optimal = outcome.convex.converged || model->num_shapes == 1;
          result.used_weights = outcome.convex.used;
          // The first alternation of a call still has last call's rotations in front of it.
          result.settled = options.settle_tolerance > 0 && result.iterations > 1 &&
                           result.change <= options.settle_tolerance;
        }
        if (report == nullptr) return;
        double nearness = 0;
        const double scale = static_cast<double>(model->rig->tables().space.scale);
        const double elastic = unknowns.ElasticEnergy(*model, &nearness);
        result.elastic = scale * std::sqrt(elastic);
        result.energy = options.square_roots ? result.elastic + scale * nearness
                                             : scale * scale * (elastic + nearness);
      },
      alternation);
  StageWatch watch(stages);
  UpdateMatrices();
  watch.Lap(&StageTimes::transforms);
  if (report != nullptr) *report = result;
  return {};
}

void PoseState::Impl::UpdateMatrices() {
  const RigSpace& space = model->rig->tables().space;
  if (model->k == 2) {
    StoreMatrices<2>(space, std::get<Alternation<2>>(alternation).Transforms(*model), &matrices);
  } else {
    StoreMatrices<3>(space, std::get<Alternation<3>>(alternation).Transforms(*model), &matrices);
  }
}

PoseState::PoseState(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

PoseState::PoseState(PoseState&&) noexcept = default;
PoseState& PoseState::operator=(PoseState&&) noexcept = default;
PoseState::~PoseState() = default;

Result<PoseState> PoseState::Create(std::shared_ptr<const PoseModel> model) {
  if (model == nullptr) return Error(StatusCode::kInvalidArgument, "no pose model was given");
  return CatchOutOfMemory(model->rig->name(), [&]() -> Result<PoseState> {
    return PoseState(std::make_unique<Impl>(model));
  });
}

Result<PoseState> PoseState::Create(std::shared_ptr<const Rig> rig) {
  Result<std::shared_ptr<const PoseModel>> model = PoseModel::Create(std::move(rig));
  if (!model.ok()) return model.status();
  return Create(std::move(model).value());
}

const Rig& PoseState::rig() const {
  return *impl_->model->rig;
}

Status PoseState::SetTarget(int handle, Vec3 position_mesh) {
  return impl_->SetTarget(handle, position_mesh);
}

Vec3 PoseState::target(int handle) const {
  const bool known = handle >= 0 && handle < static_cast<int>(impl_->targets.size());
  return known ? impl_->targets[static_cast<size_t>(handle)] : Vec3{};
}

void PoseState::ResetToRest() {
  impl_->ResetToRest();
}

Status PoseState::Solve(const PoseOptions& options, PoseReport* report) {
  return impl_->Solve(options, report);
}

SkinTransforms PoseState::transforms() const {
  const RigSpace& space = impl_->model->rig->tables().space;
  return {impl_->matrices, Vec3{space.origin[0], space.origin[1], space.origin[2]}};
}

std::span<const double> PoseState::blend_weights() const {
  const auto count = static_cast<size_t>(impl_->model->num_blocks);
  return std::visit(
      [count](const auto& unknowns) {
        return std::span<const double>(unknowns.blend().data(), count);
      },
      impl_->alternation);
}

}  // namespace limber
