#include "solve/pose_workspaces.h"

#include "solve/held_points.h"

#include <utility>

namespace limber {

PoseWorkspaces::PoseWorkspaces(std::shared_ptr<const PoseModel> model, PoseRoom most)
    : model_(std::move(model)),
      most_(most) {}

template <>
ObjectPool<Alternation<2>>& PoseWorkspaces::Pool() {
  return flat_;
}

template <>
ObjectPool<Alternation<3>>& PoseWorkspaces::Pool() {
  return solid_;
}

template <int K>
std::unique_ptr<Alternation<K>> PoseWorkspaces::Take() {
  std::unique_ptr<Alternation<K>> found = Pool<K>().Take();
  if (found != nullptr) return found;
  const size_t pins = HeldPoints::Capacity(*model_, most_.grabs, most_.rotations);
  return std::make_unique<Alternation<K>>(*model_, pins, static_cast<size_t>(most_.rotations));
}

template <int K>
void PoseWorkspaces::Give(std::unique_ptr<Alternation<K>> alternation) {
  Pool<K>().Give(std::move(alternation));
}

template std::unique_ptr<Alternation<2>> PoseWorkspaces::Take();
template std::unique_ptr<Alternation<3>> PoseWorkspaces::Take();
template void PoseWorkspaces::Give(std::unique_ptr<Alternation<2>>);
template void PoseWorkspaces::Give(std::unique_ptr<Alternation<3>>);

}  // namespace limber
