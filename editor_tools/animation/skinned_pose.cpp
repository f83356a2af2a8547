#include "animation/skinned_pose.h"

#include <Eigen/Geometry>

namespace limber::bake {
namespace {

void AddTargets(const SkinnedPrimitive& primitive, std::span<const double> weights,
                PosedPrimitive* posed) {
  for (size_t t = 0; t < primitive.targets.size(); ++t) {
    const MorphOffsets& target = primitive.targets[t];
    if (weights[t] == 0) continue;
    if (target.positions.rows() > 0) posed->positions += weights[t] * target.positions;
    if (target.normals.rows() > 0 && posed->normals.rows() > 0) {
      posed->normals += weights[t] * target.normals;
    }
  }
}

// What the inverse transpose does, up to its length and without a division: the matrix of
// cofactors is det(M) M^-T. Mirroring (det < 0) would turn it over.
Eigen::Matrix3d NormalMatrix(const Eigen::Matrix3d& m) {
  Eigen::Matrix3d cofactors;
  cofactors << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
  return cofactors.col(0).dot(m.col(0)) < 0 ? Eigen::Matrix3d(-cofactors) : cofactors;
}

Eigen::Matrix4d BlendMatrix(const SkinnedPrimitive& primitive, size_t vertex,
                            std::span<const Eigen::Matrix4d> joint_matrices) {
  Eigen::Matrix4d blend = Eigen::Matrix4d::Zero();
  const size_t first = primitive.num_influences * vertex;
  for (size_t i = first; i < first + primitive.num_influences; ++i) {
    const double weight = primitive.joint_weights[i];
    if (weight > 0) blend += weight * joint_matrices[primitive.joints[i]];
  }
  return blend;
}

void Skin(const SkinnedPrimitive& primitive, std::span<const Eigen::Matrix4d> joint_matrices,
          PosedPrimitive* posed) {
  const bool has_normals = posed->normals.rows() > 0;
  for (Eigen::Index v = 0; v < posed->positions.rows(); ++v) {
    const Eigen::Matrix4d blend = BlendMatrix(primitive, static_cast<size_t>(v), joint_matrices);
    const Eigen::Matrix3d linear = blend.topLeftCorner<3, 3>();
    const Eigen::Vector3d position = posed->positions.row(v).transpose();
    posed->positions.row(v) = (linear * position + blend.topRightCorner<3, 1>()).transpose();
    if (!has_normals) continue;
    const Eigen::Vector3d normal = posed->normals.row(v).transpose();
    posed->normals.row(v) = (NormalMatrix(linear) * normal).transpose();
  }
}

}  // namespace

PosedPrimitive PosePrimitive(const SkinnedPrimitive& primitive,
                             std::span<const double> morph_weights,
                             std::span<const Eigen::Matrix4d> joint_matrices) {
  PosedPrimitive posed{primitive.positions, primitive.normals};
  AddTargets(primitive, morph_weights, &posed);
  if (!joint_matrices.empty()) Skin(primitive, joint_matrices, &posed);
  for (Eigen::Index v = 0; v < posed.normals.rows(); ++v) {
    const double length = posed.normals.row(v).norm();
    if (length > 0 && std::isfinite(length)) {
      posed.normals.row(v) /= length;
    } else {
      posed.normals.row(v) = primitive.normals.row(v);
    }
  }
  return posed;
}

}  // namespace limber::bake
