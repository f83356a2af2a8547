#include "clips/node_transforms.h"

#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

Eigen::Vector3d ReadVector(const Json& node, const char* key, const Eigen::Vector3d& fallback) {
  const auto it = node.find(key);
  if (it == node.end()) return fallback;
  return {(*it)[0].get<double>(), (*it)[1].get<double>(), (*it)[2].get<double>()};
}

NodeTransform ReadTransform(const Json& node) {
  NodeTransform local;
  if (const auto matrix = node.find("matrix"); matrix != node.end()) {
    local.matrix.emplace();
    for (int i = 0; i < 16; ++i)
      (*local.matrix)(i % 4, i / 4) = (*matrix)[static_cast<size_t>(i)].get<double>();
    return local;
  }
  if (const auto it = node.find("rotation"); it != node.end()) {
    const Eigen::Quaterniond rotation((*it)[3].get<double>(), (*it)[0].get<double>(),
                                      (*it)[1].get<double>(), (*it)[2].get<double>());
    if (rotation.norm() > 0) local.rotation = rotation.normalized();
  }
  local.scale = ReadVector(node, "scale", local.scale);
  local.translation = ReadVector(node, "translation", local.translation);
  return local;
}

Vector<size_t> ChildrenOf(const Json& node) {
  const auto it = node.find("children");
  return it == node.end() ? Vector<size_t>() : it->get<Vector<size_t>>();
}

}  // namespace

Eigen::Matrix4d NodeTransform::Matrix() const {
  if (matrix.has_value()) return *matrix;
  Eigen::Matrix4d local = Eigen::Matrix4d::Identity();
  local.topLeftCorner<3, 3>() = rotation.toRotationMatrix() * scale.asDiagonal();
  local.topRightCorner<3, 1>() = translation;
  return local;
}

Vector<int> ParentNodes(const GltfFile& file) {
  const auto nodes = file.json().find("nodes");
  if (nodes == file.json().end()) return {};
  Vector<int> parent(nodes->size(), -1);
  for (size_t n = 0; n < nodes->size(); ++n) {
    for (const size_t child : ChildrenOf((*nodes)[n]))
      parent[child] = static_cast<int>(n);
  }
  return parent;
}

Vector<NodeTransform> LocalTransforms(const GltfFile& file) {
  const auto nodes = file.json().find("nodes");
  if (nodes == file.json().end()) return {};
  Vector<NodeTransform> local;
  for (const Json& node : *nodes)
    local.push_back(ReadTransform(node));
  return local;
}

Vector<Eigen::Matrix4d> WorldTransforms(const GltfFile& file,
                                        std::span<const NodeTransform> local) {
  const auto nodes = file.json().find("nodes");
  if (nodes == file.json().end()) return {};
  Vector<Eigen::Matrix4d> world(nodes->size());
  const Vector<int> parent = ParentNodes(file);
  // Parents before children, with a list instead of recursion: hierarchies may be long.
  Vector<size_t> order;
  for (size_t n = 0; n < nodes->size(); ++n) {
    world[n] = local[n].Matrix();
    if (parent[n] < 0) order.push_back(n);
  }
  for (size_t i = 0; i < order.size(); ++i) {
    for (const size_t child : ChildrenOf((*nodes)[order[i]])) {
      world[child] = world[order[i]] * world[child];
      order.push_back(child);
    }
  }
  return world;
}

Vector<Eigen::Matrix4d> WorldTransforms(const GltfFile& file) {
  return WorldTransforms(file, LocalTransforms(file));
}

}  // namespace limber
