// World transforms of a glTF's nodes.
#pragma once

#include "load/gltf_file.h"

#include <Eigen/Core>

#include <vector>

namespace limber::bake {

// node -> world, for every node; the hierarchy was found to be a forest when the file was opened.
std::vector<Eigen::Matrix4d> WorldTransforms(const GltfFile& file);

}  // namespace limber::bake
