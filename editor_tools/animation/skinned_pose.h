// Morphing and linear blend skinning: what a GPU would draw, in double precision and mesh space.
#pragma once

#include "animation/skinned_mesh.h"

#include <Eigen/Core>

#include <span>

namespace limber::bake {

struct PosedPrimitive {
  PointMatrix positions;  // V x 3
  PointMatrix normals;    // V x 3, unit length; or no rows, as the primitive
};

// Adds the morph targets by their weights (T; primitives without targets take none), then blends
// the joint matrices (skin.h) by each vertex's weights: position p' = sum w_j M_j p; normal
// n' = M^-T n with M = sum w_j M_j, made unit. No matrix: the primitive is morphed only. A normal
// that vanishes stays what it was.
PosedPrimitive PosePrimitive(const SkinnedPrimitive& primitive,
                             std::span<const double> morph_weights,
                             std::span<const Eigen::Matrix4d> joint_matrices);

}  // namespace limber::bake
