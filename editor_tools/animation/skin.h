// A glTF skin: joints with their inverse bind matrices, and the way back to mesh space.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

struct Skin {
  Vector<int> joints;                    // J: nodes
  Vector<Eigen::Matrix4d> inverse_bind;  // J: mesh space at bind -> joint
  size_t root = 0;                       // the topmost joint above the first one, or that
};

// Errors, without the file's name: kMalformed (no such skin, joints or matrices that are not in the
// file, a last row of a matrix other than 0 0 0 1).
Result<Skin> ReadSkin(const GltfFile& file, int skin);

// World -> mesh space of the bind pose. At bind, joint j stands at inverse(inverse_bind[j]) in mesh
// space, and the world differs from that by one common transform, which may scale and turn; it is
// taken where the root joint stands when nothing is animated (other joints may be out of the bind
// pose there). rest_world: node -> world, nothing animated. Errors, without the file's name:
// kMalformed (a root without an inverse).
Result<Eigen::Matrix4d> WorldToMesh(const GltfFile& file, const Skin& skin,
                                    std::span<const Eigen::Matrix4d> rest_world);

// Of each joint: mesh space at bind -> mesh space, posed. world: node -> world at the moment.
Vector<Eigen::Matrix4d> JointMatrices(const Skin& skin, std::span<const Eigen::Matrix4d> world,
                                      const Eigen::Matrix4d& world_to_mesh);

}  // namespace limber::bake
