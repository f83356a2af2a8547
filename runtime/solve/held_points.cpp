#include "solve/held_points.h"

#include "core/out_of_memory.h"
#include "core/rotation_fit.h"
#include "core/vector.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

namespace limber {
namespace {

constexpr float kFarthestTarget = 1e6f;  // rig units: sizes of the character
constexpr float kSoftest = 1e-6f, kStiffest = 1e9f;

const char* NameOf(const Rig& rig, int handle) {
  return rig.tables().handles[static_cast<size_t>(handle)].name.c_str();
}

// In double: a target far from the origin keeps its digits until it is centred.
std::array<double, 3> ToRigSpace(const Rig& rig, Vec3 position) {
  const RigSpace& space = rig.tables().space;
  std::array<double, 3> local = {};
  for (int axis = 0; axis < rig.dimension(); ++axis) {
    double turned = 0;
    for (int a = 0; a < 3; ++a) {
      turned +=
          static_cast<double>(space.basis[3 * static_cast<size_t>(axis) + static_cast<size_t>(a)]) *
          (static_cast<double>(position[a]) -
           static_cast<double>(space.origin[static_cast<size_t>(a)]));
    }
    local[static_cast<size_t>(axis)] = turned / static_cast<double>(space.scale);
  }
  return local;
}

// handle: whose target it is to be, -1 for a grab's.
Status CheckPosition(const Rig& rig, Vec3 position, int handle) {
  const auto refuse = [&](const char* reason) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: %s '%s': target (%g, %g, %g) is %s; the old one is kept", rig.name().c_str(),
                 handle < 0 ? "grab of" : "handle", handle < 0 ? "the skin" : NameOf(rig, handle),
                 static_cast<double>(position.x), static_cast<double>(position.y),
                 static_cast<double>(position.z), reason);
  };
  if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z))
    return refuse("not finite");
  const Vec3 local = rig.ToRig(position);
  const float largest = std::max({std::abs(local.x), std::abs(local.y), std::abs(local.z)});
  if (!(largest <= kFarthestTarget))
    return refuse("over a million times the character's size away");
  return {};
}

// More than the handles' positions can be held only where the file says how the models of one
// shape move.
Status CheckHoldsMore(const Rig& rig) {
  if (rig.num_shapes() == 1 || !rig.tables().single_mode_transforms.empty()) return {};
  return Error(StatusCode::kUnsupported,
               "%s: baked in format version 1, in which only handles' positions can be held; bake "
               "it again",
               rig.name().c_str());
}

Status CheckStiffness(const Rig& rig, float stiffness) {
  if (stiffness == kHeldExactly || (stiffness >= kSoftest && stiffness <= kStiffest)) return {};
  return Error(StatusCode::kInvalidArgument,
               "%s: stiffness %g; expected %g to %g, or infinity to hold exactly",
               rig.name().c_str(), static_cast<double>(stiffness), static_cast<double>(kSoftest),
               static_cast<double>(kStiffest));
}

double Compliance(float stiffness) {
  return stiffness == kHeldExactly ? 0 : 1 / static_cast<double>(stiffness);
}

// In rig space, k x k row-major; in the plane the part about the plane's normal.
std::array<double, 9> RotationInRig(const Rig& rig, Quaternion q) {
  const Eigen::Quaterniond turn(static_cast<double>(q.w), static_cast<double>(q.x),
                                static_cast<double>(q.y), static_cast<double>(q.z));
  const Eigen::Matrix3d basis =
      Eigen::Map<const Eigen::Matrix3f>(rig.tables().space.basis.data()).cast<double>();
  const Eigen::Matrix3d local = basis.transpose() * turn.normalized().toRotationMatrix() * basis;
  std::array<double, 9> rotation = {};
  if (rig.dimension() == 2) {
    const Eigen::Matrix2d flat = FitRotation<2>(local.topLeftCorner<2, 2>().transpose());
    Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>{rotation.data()} = flat;
  } else {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{rotation.data()} = local;
  }
  return rotation;
}

Status NoSuchGrab(const Rig& rig, int grab) {
  return Error(StatusCode::kInvalidArgument, "%s: grab %d is not held (it was released, perhaps)",
               rig.name().c_str(), grab);
}

}  // namespace

HeldPoints::Room::Room(const Rig& rig, size_t num_handles, size_t num_extra_rows, size_t max_turns)
    : extra_rows(rig, num_extra_rows),
      pins(rig, num_handles + num_extra_rows, max_turns) {}

size_t HeldPoints::Capacity(const PoseModel& model, int grabs, int rotations) {
  return model.rig->tables().handles.size() + static_cast<size_t>(grabs) +
         static_cast<size_t>(rotations) * static_cast<size_t>(model.k);
}

HeldPoints::HeldPoints(const PoseModel& model, int grabs, int rotations, bool later)
    : dimension_(static_cast<size_t>(model.k)),
      handles_(model.rig->tables().handles.size()),
      weights_(handles_.size()),
      turns_(static_cast<size_t>(rotations)),
      grabs_(static_cast<size_t>(grabs)),
      pins_(model.pins.get()) {
  pinned_.reserve(handles_.size());
  Reset(model);
  if (later) return;
  const Status made = MakeRoom(*model.rig);
  if (!made.ok()) throw std::bad_alloc();  // for whoever creates the state
}

Status HeldPoints::MakeRoom(const Rig& rig) {
  if (room_ != nullptr) return {};
  return CatchOutOfMemory(rig.name(), [&]() -> Status {
    const size_t extra = turns_.size() * dimension_ + grabs_.size();
    auto room = std::make_unique<Room>(rig, handles_.size(), extra, turns_.size());
    holds_.reserve(room->pins.capacity());
    turned_.reserve(turns_.size());
    room_ = std::move(room);
    return {};
  });
}

void HeldPoints::Reset(const PoseModel& model) {
  const Vector<RigHandle>& handles = model.rig->tables().handles;
  for (size_t h = 0; h < handles.size(); ++h) {
    handles_[h] = {handles[h].pinned, 0, handles[h].rest_position,
                   ToRigSpace(*model.rig, handles[h].rest_position)};
  }
  std::fill(weights_.begin(), weights_.end(), 1.0);
  pinned_.assign(model.pinned_handles.begin(), model.pinned_handles.end());
  std::fill(turns_.begin(), turns_.end(), Turn());
  std::fill(grabs_.begin(), grabs_.end(), Grabbed());
  is_changed_ = pins_ != model.pins.get();
  pins_ = model.pins.get();
}

Status HeldPoints::CheckHandle(const Rig& rig, int handle) const {
  if (handle >= 0 && handle < static_cast<int>(handles_.size())) return {};
  return Error(StatusCode::kInvalidArgument, "%s: handle %d; expected 0 to %zu", rig.name().c_str(),
               handle, handles_.size() - 1);
}

Status HeldPoints::SetTarget(const Rig& rig, int handle, Vec3 position) {
  LIMBER_RETURN_IF_ERROR(CheckHandle(rig, handle));
  Point& point = handles_[static_cast<size_t>(handle)];
  if (!point.held) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: handle '%s' is free and takes no target; pin it first (Pin), or bake "
                 "it as pinned",
                 rig.name().c_str(), NameOf(rig, handle));
  }
  if (position == point.target) return {};
  LIMBER_RETURN_IF_ERROR(CheckPosition(rig, position, handle));
  point.target = position;
  point.target_rig = ToRigSpace(rig, position);
  return {};
}

Status HeldPoints::Pin(const Rig& rig, int handle, Vec3 place) {
  LIMBER_RETURN_IF_ERROR(CheckHandle(rig, handle));
  Point& point = handles_[static_cast<size_t>(handle)];
  if (point.held) return {};
  LIMBER_RETURN_IF_ERROR(CheckPosition(rig, place, handle));
  LIMBER_RETURN_IF_ERROR(MakeRoom(rig));
  is_changed_ = point.held = true;
  point.target = place;
  point.target_rig = ToRigSpace(rig, place);
  return {};
}

Status HeldPoints::Unpin(const Rig& rig, int handle) {
  LIMBER_RETURN_IF_ERROR(CheckHandle(rig, handle));
  LIMBER_RETURN_IF_ERROR(MakeRoom(rig));
  Point& point = handles_[static_cast<size_t>(handle)];
  is_changed_ |= point.held;
  point.held = false;
  return {};
}

Status HeldPoints::SetStiffness(const Rig& rig, int handle, float stiffness) {
  LIMBER_RETURN_IF_ERROR(CheckHandle(rig, handle));
  LIMBER_RETURN_IF_ERROR(CheckStiffness(rig, stiffness));
  LIMBER_RETURN_IF_ERROR(MakeRoom(rig));
  Point& point = handles_[static_cast<size_t>(handle)];
  is_changed_ |= point.compliance != Compliance(stiffness);
  point.compliance = Compliance(stiffness);
  return {};
}

Status HeldPoints::SetWeight(const Rig& rig, int handle, float weight) {
  LIMBER_RETURN_IF_ERROR(CheckHandle(rig, handle));
  if (!(weight >= kSoftest && (weight <= kStiffest || weight == kHeldExactly))) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: handle '%s': weight %g; expected %g to %g, or infinity not to give way",
                 rig.name().c_str(), NameOf(rig, handle), static_cast<double>(weight),
                 static_cast<double>(kSoftest), static_cast<double>(kStiffest));
  }
  weights_[static_cast<size_t>(handle)] = static_cast<double>(weight);
  return {};
}

// Only the handle's first rotation, and a change of stiffness, change what is held; later ones
// change the targets alone.
Status HeldPoints::SetRotation(const Rig& rig, int handle, Quaternion rotation, float stiffness) {
  LIMBER_RETURN_IF_ERROR(CheckHandle(rig, handle));
  LIMBER_RETURN_IF_ERROR(CheckStiffness(rig, stiffness));
  const float squared = rotation.x * rotation.x + rotation.y * rotation.y +
                        rotation.z * rotation.z + rotation.w * rotation.w;
  if (!std::isfinite(squared) || !(squared > 1e-12f)) {
    return Error(StatusCode::kInvalidArgument,
                 "%s: handle '%s': rotation (%g, %g, %g, %g) is not a quaternion; the old one is "
                 "kept",
                 rig.name().c_str(), NameOf(rig, handle), static_cast<double>(rotation.x),
                 static_cast<double>(rotation.y), static_cast<double>(rotation.z),
                 static_cast<double>(rotation.w));
  }
  const auto is_of = [](int wanted) {
    return [wanted](const Turn& t) { return t.handle == wanted; };
  };
  auto turn = std::find_if(turns_.begin(), turns_.end(), is_of(handle));
  if (turn == turns_.end()) {
    LIMBER_RETURN_IF_ERROR(CheckHoldsMore(rig));
    turn = std::find_if(turns_.begin(), turns_.end(), is_of(-1));
    if (turn == turns_.end()) {
      return Error(StatusCode::kLimitExceeded,
                   "%s: handle '%s': %zu handles are turned already; clear one, or create the "
                   "state with room for more",
                   rig.name().c_str(), NameOf(rig, handle), turns_.size());
    }
    LIMBER_RETURN_IF_ERROR(MakeRoom(rig));
    turn->patch = room_->extra_rows.FillAxes(
        rig, turn_row(static_cast<size_t>(turn - turns_.begin())), handle);
    turn->handle = handle;
    is_changed_ = true;
  }
  is_changed_ |= turn->compliance != Compliance(stiffness);
  turn->compliance = Compliance(stiffness);
  turn->rotation = RotationInRig(rig, rotation);
  return {};
}

Status HeldPoints::ClearRotation(const Rig& rig, int handle) {
  LIMBER_RETURN_IF_ERROR(CheckHandle(rig, handle));
  for (Turn& turn : turns_) {
    if (turn.handle != handle) continue;
    turn = {};
    is_changed_ = true;
  }
  return {};
}

// An id is the slot and a number that no other grab of the slot has had.
HeldPoints::Grabbed* HeldPoints::FindGrab(int grab) {
  if (grab < 0 || grabs_.empty()) return nullptr;
  Grabbed& found = grabs_[static_cast<size_t>(grab) % grabs_.size()];
  return found.held && found.id == grab ? &found : nullptr;
}

Result<int> HeldPoints::Grab(const Rig& rig, const SkinPoint& point, Vec3 place, float stiffness) {
  LIMBER_RETURN_IF_ERROR(CheckHoldsMore(rig));
  LIMBER_RETURN_IF_ERROR(CheckStiffness(rig, stiffness));
  LIMBER_RETURN_IF_ERROR(CheckPosition(rig, place, -1));
  const auto slot = static_cast<size_t>(
      std::find_if(grabs_.begin(), grabs_.end(), [](const Grabbed& g) { return !g.held; }) -
      grabs_.begin());
  if (slot == grabs_.size()) {
    return Error(StatusCode::kLimitExceeded,
                 "%s: %zu points of the skin are grabbed already; release one, or create the state "
                 "with room for more",
                 rig.name().c_str(), grabs_.size());
  }
  LIMBER_RETURN_IF_ERROR(MakeRoom(rig));
  room_->extra_rows.FillPoint(rig, grab_row(slot), point);
  Grabbed& grab = grabs_[slot];
  const int round = grab.id < 0 ? 0 : grab.id / static_cast<int>(grabs_.size()) + 1;
  grab.id = (round % (1 << 20)) * static_cast<int>(grabs_.size()) + static_cast<int>(slot);
  grab.held = is_changed_ = true;
  grab.compliance = Compliance(stiffness);
  grab.target = place;
  grab.target_rig = ToRigSpace(rig, place);
  return grab.id;
}

Status HeldPoints::SetGrabTarget(const Rig& rig, int grab, Vec3 position) {
  Grabbed* grabbed = FindGrab(grab);
  if (grabbed == nullptr) return NoSuchGrab(rig, grab);
  LIMBER_RETURN_IF_ERROR(CheckPosition(rig, position, -1));
  grabbed->target = position;
  grabbed->target_rig = ToRigSpace(rig, position);
  return {};
}

Status HeldPoints::Release(const Rig& rig, int grab) {
  Grabbed* grabbed = FindGrab(grab);
  if (grabbed == nullptr) return NoSuchGrab(rig, grab);
  grabbed->held = false;
  is_changed_ = true;
  return {};
}

Vec3 HeldPoints::target(int handle) const {
  const bool known = handle >= 0 && handle < static_cast<int>(handles_.size());
  return known ? handles_[static_cast<size_t>(handle)].target : Vec3{};
}

bool HeldPoints::is_pinned(int handle) const {
  const bool known = handle >= 0 && handle < static_cast<int>(handles_.size());
  return known && handles_[static_cast<size_t>(handle)].held;
}

bool HeldPoints::holds_anything() const {
  const auto is_held = [](const Point& point) { return point.held; };
  return std::any_of(handles_.begin(), handles_.end(), is_held) ||
         std::any_of(grabs_.begin(), grabs_.end(), is_held);
}

bool HeldPoints::holds_points_exactly() const {
  const auto is_soft = [](const Point& point) { return point.held && point.compliance != 0; };
  const auto is_turned = [](const Turn& turn) { return turn.handle >= 0; };
  return std::none_of(handles_.begin(), handles_.end(), is_soft) &&
         std::none_of(grabs_.begin(), grabs_.end(), is_soft) &&
         std::none_of(turns_.begin(), turns_.end(), is_turned);
}

const PinSet& HeldPoints::Pins(const PoseModel& model, bool* changed) {
  *changed = is_changed_;
  is_changed_ = false;
  if (!*changed) return *pins_;
  pinned_.clear();
  for (size_t h = 0; h < handles_.size(); ++h) {
    if (handles_[h].held) pinned_.push_back(static_cast<int>(h));
  }
  if (IsAsBaked(model.rig->tables())) {
    pins_ = model.pins.get();
    return *pins_;
  }
  holds_.clear();
  turned_.clear();
  for (size_t h = 0; h < handles_.size(); ++h) {
    if (handles_[h].held) holds_.push_back({model.handle_rows->row(h), handles_[h].compliance});
  }
  for (size_t slot = 0; slot < turns_.size(); ++slot) {
    if (turns_[slot].handle < 0) continue;
    turned_.push_back({holds_.size(), turns_[slot].patch});
    for (size_t axis = 0; axis < turns_[slot].patch.count; ++axis)
      holds_.push_back({room_->extra_rows.row(turn_row(slot) + axis), turns_[slot].compliance});
  }
  for (size_t slot = 0; slot < grabs_.size(); ++slot) {
    if (grabs_[slot].held)
      holds_.push_back({room_->extra_rows.row(grab_row(slot)), grabs_[slot].compliance});
  }
  room_->pins.Build(*model.rig, holds_, turned_);
  pins_ = &room_->pins;
  return *pins_;
}

bool HeldPoints::IsAsBaked(const RigTables& tables) const {
  for (size_t h = 0; h < handles_.size(); ++h) {
    if (handles_[h].held != tables.handles[h].pinned) return false;
  }
  const auto is_held = [](const Grabbed& grab) { return grab.held; };
  return holds_points_exactly() && std::none_of(grabs_.begin(), grabs_.end(), is_held);
}

void HeldPoints::StoreTargets(double* targets, double* rotations) const {
  const auto store = [&](const double* from) { targets = std::copy_n(from, dimension_, targets); };
  for (const Point& point : handles_) {
    if (point.held) store(point.target_rig.data());
  }
  for (const Turn& turn : turns_) {
    if (turn.handle < 0) continue;
    targets += turn.patch.count * dimension_;
    rotations = std::copy_n(turn.rotation.data(), dimension_ * dimension_, rotations);
  }
  for (const Grabbed& grab : grabs_) {
    if (grab.held) store(grab.target_rig.data());
  }
}

}  // namespace limber
