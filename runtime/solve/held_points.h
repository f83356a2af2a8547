// One character's bookkeeping of what is held: which handles, how stiffly, turned how, and which
// points of the skin have been grabbed. Turns it into a PinSet and its targets when it changes.
#pragma once

#include "core/quaternion.h"
#include "core/status.h"
#include "core/vec3.h"
#include "core/vector.h"
#include "solve/held_rows.h"
#include "solve/pin_set.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>

namespace limber {

class HeldPoints {
 public:
  // grabs, rotations: how many of each there may be at once. later: the room for other pins than
  // the rig's own (ten times the rest) is made by the first call that asks for some, which may then
  // end with kOutOfMemory.
  HeldPoints(const PoseModel& model, int grabs, int rotations, bool later = false);

  // Rows of the largest pin set that there can be.
  static size_t Capacity(const PoseModel& model, int grabs, int rotations);

  // The rig's pinned handles at their rest positions, exactly; no rotation, no grab.
  void Reset(const PoseModel& model);

  // All positions in mesh space. Errors as in pose_solver.h, the old value being kept.
  Status SetTarget(const Rig& rig, int handle, Vec3 position);
  Status Pin(const Rig& rig, int handle, Vec3 place);
  Status Unpin(const Rig& rig, int handle);
  Status SetStiffness(const Rig& rig, int handle, float stiffness);
  Status SetWeight(const Rig& rig, int handle, float weight);
  Status SetRotation(const Rig& rig, int handle, Quaternion rotation, float stiffness);
  Status ClearRotation(const Rig& rig, int handle);
  Result<int> Grab(const Rig& rig, const SkinPoint& point, Vec3 place, float stiffness);
  Status SetGrabTarget(const Rig& rig, int grab, Vec3 position);
  Status Release(const Rig& rig, int grab);

  Vec3 target(int handle) const;
  bool is_pinned(int handle) const;

  // False where nothing holds the character: there is then no pin set.
  bool holds_anything() const;

  // What is held now; built anew where that changed since the last call. *changed says so.
  const PinSet& Pins(const PoseModel& model, bool* changed);

  // X, [c][k] in rig space, in the order of Pins' rows: the pinned handles in their order, then
  // the axes of the handles that are turned (left alone), then the grabs. And the rotations that
  // these are turned to, [turns][k][k] row-major.
  void StoreTargets(double* targets, double* rotations) const;

  // False: something is turned, or held softly.
  bool holds_points_exactly() const;

  // Those that are pinned, ascending, as of the last Pins; their positions are the first rows.
  std::span<const int> pinned() const { return pinned_; }

  const double* weights() const { return weights_.data(); }  // [H], of SetWeight

  size_t max_turns() const { return turns_.size(); }

 private:
  struct Point {
    bool held = false;
    double compliance = 0;
    Vec3 target;  // mesh space, as set
    std::array<double, 3> target_rig = {};
  };

  struct Turn {
    int handle = -1;  // -1: the slot is empty
    double compliance = 0;
    PatchAxes patch;
    std::array<double, 9> rotation = {};  // rig space, k x k row-major
  };

  struct Grabbed : Point {
    int id = -1;
  };

  // For pins of its own.
  struct Room : NewFromSource {
    Room(const Rig& rig, size_t num_handles, size_t num_extra_rows, size_t max_turns);

    HeldRowTable extra_rows;  // of the turns, then of the grabs
    PinSet pins;
  };

  Status MakeRoom(const Rig& rig);
  Status CheckHandle(const Rig& rig, int handle) const;
  Grabbed* FindGrab(int grab);
  bool IsAsBaked(const RigTables& tables) const;

  size_t turn_row(size_t slot) const { return slot * dimension_; }

  size_t grab_row(size_t slot) const { return turns_.size() * dimension_ + slot; }

  size_t dimension_;
  Vector<Point> handles_;
  Vector<double> weights_;  // [H]
  Vector<int> pinned_;
  Vector<Turn> turns_;
  Vector<Grabbed> grabs_;
  std::unique_ptr<Room> room_;  // null: not made yet
  Vector<Hold> holds_;          // scratch
  Vector<TurnedPatch> turned_;  // scratch
  bool is_changed_ = false;
  const PinSet* pins_;  // the model's while nothing was changed
};

}  // namespace limber
