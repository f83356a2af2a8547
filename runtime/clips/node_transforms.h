// Local and world transforms of a glTF's nodes.
#pragma once

#include "core/vector.h"
#include "load/gltf_file.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>

namespace limber {

// Where a node stands in its parent: translation * rotation * scale (glTF 2.0, section 3.5.3), or a
// matrix instead of the three.
struct NodeTransform {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  std::optional<Eigen::Matrix4d> matrix;

  Eigen::Matrix4d Matrix() const;
};

// Of every node the node above it; -1: none.
Vector<int> ParentNodes(const GltfFile& file);

// Of every node, as the file has it at rest.
Vector<NodeTransform> LocalTransforms(const GltfFile& file);

// node -> world, for every node; the hierarchy was found to be a forest when the file was opened.
// local: one for each node.
Vector<Eigen::Matrix4d> WorldTransforms(const GltfFile& file, std::span<const NodeTransform> local);

// The same at rest.
Vector<Eigen::Matrix4d> WorldTransforms(const GltfFile& file);

}  // namespace limber
