// Alternations that many characters of one rig use in turn. An alternation is mostly scratch
// memory; what a character has to keep is a small part of it (Alternation::Memory). So a crowd
// takes little memory, and the scratch of each thread stays in its caches.
#pragma once

#include "core/object_pool.h"
#include "solve/alternation.h"
#include "solve/pose_model.h"
#include "solve/pose_solver.h"

#include <memory>

namespace limber {

class PoseWorkspaces {
 public:
  // For states of that model with at most that room, the guaranteed mode apart.
  PoseWorkspaces(std::shared_ptr<const PoseModel> model, PoseRoom most);

  const std::shared_ptr<const PoseModel>& model() const { return model_; }

  bool HasRoomFor(const PoseRoom& room) const {
    return room.grabs <= most_.grabs && room.rotations <= most_.rotations && !room.guaranteed;
  }

  // Throws std::bad_alloc where one has to be made, which is as often as there are more at once
  // than ever before.
  template <int K>
  std::unique_ptr<Alternation<K>> Take();

  template <int K>
  void Give(std::unique_ptr<Alternation<K>> alternation);

 private:
  template <int K>
  ObjectPool<Alternation<K>>& Pool();

  std::shared_ptr<const PoseModel> model_;
  PoseRoom most_;
  ObjectPool<Alternation<2>> flat_;
  ObjectPool<Alternation<3>> solid_;
};

}  // namespace limber
