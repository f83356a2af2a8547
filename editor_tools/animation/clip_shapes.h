// The shapes that a clip gives one mesh node.
#pragma once

#include "animation/skin.h"
#include "animation/skinned_mesh.h"
#include "animation/skinned_pose.h"
#include "clips/animation_clip.h"
#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"

#include <optional>

namespace limber::bake {

// Whether the clip moves a joint of the mesh node's skin, a node above one, or the node's morph
// target weights (exporters write down weights that are always zero: those do not count). A skin
// that cannot be read counts as moved: ClipShapes says what is wrong with it.
bool ClipDeforms(const GltfFile& file, const AnimationClip& clip, int node);

// A mesh node as it is at rest, with its skin, ready to be posed. The file must outlive it.
class ClipShapes {
 public:
  // Errors, without the file's name: those of ReadSkin, WorldToMesh and ReadSkinnedMesh; kMalformed
  // (weights at rest that do not fit the targets).
  static Result<ClipShapes> Create(const GltfFile& file, int node);

  const SkinnedMesh& mesh() const { return mesh_; }

  bool has_skin() const { return skin_.has_value(); }

  // All primitives at that time, mesh space of the bind pose. in_place: as in PackClipOptions.
  Vector<PosedPrimitive> ShapeAt(const AnimationClip& clip, double time, bool in_place) const;

 private:
  ClipShapes() = default;
  Vector<Eigen::Matrix4d> JointMatricesAt(const AnimationClip& clip, double time,
                                          bool in_place) const;

  const GltfFile* file_ = nullptr;
  int node_ = -1;
  SkinnedMesh mesh_;
  Vector<double> rest_weights_;
  Vector<NodeTransform> rest_local_;
  std::optional<Skin> skin_;
  Eigen::Matrix4d world_to_mesh_ = Eigen::Matrix4d::Identity();
  Eigen::Vector3d rest_root_ = Eigen::Vector3d::Zero();  // world place of the root joint
};

}  // namespace limber::bake
