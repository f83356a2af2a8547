#include "solve/pose_solver.h"

#include "core/out_of_memory.h"
#include "solve/alternation.h"
#include "solve/held_points.h"
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
constexpr int kMostExtraHolds = 1000;  // of each kind: more is a mistake

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
  Impl(std::shared_ptr<const PoseModel> model, PoseRoom room);

  void ResetToRest();
  Status Solve(const PoseOptions& options, PoseReport* report);
  void UpdateMatrices();
  Vec3 Place(const SkinPoint& point) const;

  std::shared_ptr<const PoseModel> model;
  HeldPoints held;
  std::vector<float> matrices;  // [H][S][3][4]
  std::variant<Alternation<2>, Alternation<3>> alternation;

 private:
  static std::variant<Alternation<2>, Alternation<3>> MakeAlternation(const PoseModel& model,
                                                                      const HeldPoints& held) {
    if (model.k == 2) return Alternation<2>(model, held.capacity(), held.max_turns());
    return Alternation<3>(model, held.capacity(), held.max_turns());
  }
};

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
  if (!held.holds_anything()) {
    return Error(StatusCode::kNoHandles,
                 "%s: nothing is held, so the character could be anywhere; pin a handle or grab "
                 "the skin",
                 model->rig->name().c_str());
  }
  PoseReport result;
  bool pins_changed = false;
  const PinSet& pins = held.Pins(*model, &pins_changed);
  StageTimes* const stages = options.measure_stages ? &result.stages : nullptr;
  std::visit(
      [&](auto& unknowns) {
        if (pins_changed) unknowns.UsePins(*model, pins);
        held.StoreTargets(unknowns.targets.data(), unknowns.turn_targets().data());
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

PoseState::PoseState(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

PoseState::PoseState(PoseState&&) noexcept = default;
PoseState& PoseState::operator=(PoseState&&) noexcept = default;
PoseState::~PoseState() = default;

Result<PoseState> PoseState::Create(std::shared_ptr<const PoseModel> model, PoseRoom room) {
  if (model == nullptr) return Error(StatusCode::kInvalidArgument, "no pose model was given");
  if (room.grabs < 0 || room.grabs > kMostExtraHolds || room.rotations < 0 ||
      room.rotations > kMostExtraHolds) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: room for %d grabs and %d rotations; expected 0 to %d of each",
                 model->rig->name().c_str(), room.grabs, room.rotations, kMostExtraHolds);
  }
  return CatchOutOfMemory(model->rig->name(), [&]() -> Result<PoseState> {
    return PoseState(std::make_unique<Impl>(model, room));
  });
}

Result<PoseState> PoseState::Create(std::shared_ptr<const Rig> rig, PoseRoom room) {
  Result<std::shared_ptr<const PoseModel>> model = PoseModel::Create(std::move(rig));
  if (!model.ok()) return model.status();
  return Create(std::move(model).value(), room);
}

const Rig& PoseState::rig() const {
  return *impl_->model->rig;
}

Status PoseState::SetTarget(int handle, Vec3 position_mesh) {
  return impl_->held.SetTarget(rig(), handle, position_mesh);
}

Vec3 PoseState::target(int handle) const {
  return impl_->held.target(handle);
}

Status PoseState::Pin(int handle) {
  const std::vector<RigHandle>& handles = rig().tables().handles;
  const bool known = handle >= 0 && handle < rig().num_handles();
  const uint32_t vertex = known ? handles[static_cast<size_t>(handle)].vertex : 0;
  return impl_->held.Pin(rig(), handle, impl_->Place({{vertex, vertex, vertex}, {1, 0, 0}}));
}

Status PoseState::Unpin(int handle) {
  return impl_->held.Unpin(rig(), handle);
}

bool PoseState::is_pinned(int handle) const {
  return impl_->held.is_pinned(handle);
}

Status PoseState::SetStiffness(int handle, float stiffness) {
  return impl_->held.SetStiffness(rig(), handle, stiffness);
}

Status PoseState::SetRotation(int handle, Quaternion rotation, float stiffness) {
  return impl_->held.SetRotation(rig(), handle, rotation, stiffness);
}

Status PoseState::ClearRotation(int handle) {
  return impl_->held.ClearRotation(rig(), handle);
}

Result<int> PoseState::Grab(const SkinPoint& point, float stiffness) {
  LIMBER_RETURN_IF_ERROR(CheckSkinPoint(rig(), point));
  return impl_->held.Grab(rig(), point, impl_->Place(point), stiffness);
}

Status PoseState::SetGrabTarget(int grab, Vec3 position_mesh) {
  return impl_->held.SetGrabTarget(rig(), grab, position_mesh);
}

Status PoseState::Release(int grab) {
  return impl_->held.Release(rig(), grab);
}

Vec3 PoseState::Place(const SkinPoint& point) const {
  return CheckSkinPoint(rig(), point).ok() ? impl_->Place(point) : Vec3{};
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
