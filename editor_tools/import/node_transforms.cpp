#include "import/node_transforms.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <cstdint>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

Eigen::Vector3d ReadVector(const Json& node, const char* key, const Eigen::Vector3d& fallback) {
  const auto it = node.find(key);
  if (it == node.end()) return fallback;
  return {(*it)[0].get<double>(), (*it)[1].get<double>(), (*it)[2].get<double>()};
}

Eigen::Matrix4d LocalTransform(const Json& node) {
  Eigen::Matrix4d local = Eigen::Matrix4d::Identity();
  if (const auto matrix = node.find("matrix"); matrix != node.end()) {
    for (int i = 0; i < 16; ++i)
      local(i % 4, i / 4) = (*matrix)[static_cast<size_t>(i)].get<double>();
    return local;
  }
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (const auto it = node.find("rotation"); it != node.end()) {
    rotation = Eigen::Quaterniond((*it)[3].get<double>(), (*it)[0].get<double>(),
                                  (*it)[1].get<double>(), (*it)[2].get<double>());
    if (rotation.norm() > 0) rotation.normalize();
  }
  const Eigen::Vector3d scale = ReadVector(node, "scale", Eigen::Vector3d::Ones());
  local.topLeftCorner<3, 3>() = rotation.toRotationMatrix() * scale.asDiagonal();
  local.topRightCorner<3, 1>() = ReadVector(node, "translation", Eigen::Vector3d::Zero());
  return local;
}

}  // namespace

std::vector<Eigen::Matrix4d> WorldTransforms(const GltfFile& file) {
  const auto nodes = file.json().find("nodes");
  if (nodes == file.json().end()) return {};
  std::vector<Eigen::Matrix4d> world(nodes->size());
  std::vector<bool> is_child(nodes->size(), false);
  const auto children_of = [&](size_t n) {
    std::vector<size_t> children;
    if (const auto it = (*nodes)[n].find("children"); it != (*nodes)[n].end()) {
      children = it->get<std::vector<size_t>>();
    }
    return children;
  };
  for (size_t n = 0; n < nodes->size(); ++n) {
    world[n] = LocalTransform((*nodes)[n]);
    for (const size_t child : children_of(n))
      is_child[child] = true;
  }
  // Parents before children, with a list instead of recursion: hierarchies may be long.
  std::vector<size_t> order;
  for (size_t n = 0; n < nodes->size(); ++n) {
    if (!is_child[n]) order.push_back(n);
  }
  for (size_t i = 0; i < order.size(); ++i) {
    for (const size_t child : children_of(order[i])) {
      world[child] = world[order[i]] * world[child];
      order.push_back(child);
    }
  }
  return world;
}

}  // namespace limber::bake
