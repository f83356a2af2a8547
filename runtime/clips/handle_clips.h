// A file's own animations as far as they move a rig's handles against its mesh: channels on the
// handles' nodes, on nodes above them, or on the mesh's (handles then stay where they are while the
// mesh moves on). Sampled in mesh space. Immutable; any number of threads.
#pragma once

#include "clips/animation_clip.h"
#include "clips/node_transforms.h"
#include "core/quaternion.h"
#include "core/status.h"
#include "load/gltf_file.h"
#include "rig/rig.h"

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace limber {

// Where a clip has a handle at a moment; mesh space.
struct HandlePlace {
  Vec3 position;
  Quaternion rotation;  // from rest; the identity where the clip turns nothing
  bool is_turned = false;
};

class HandleClips {
 public:
  // Clips that move no handle are left out, and so are those that cannot be read: each of these is
  // named in a line of `warnings`. Errors: kInvalidArgument (no such rig), kOutOfMemory.
  static Result<std::shared_ptr<const HandleClips>> Read(const GltfFile& file, const Rig& rig,
                                                         int rig_index,
                                                         std::vector<std::string>* warnings);

  int num_clips() const { return static_cast<int>(clips_.size()); }

  const std::string& name(int clip) const { return At(clip).name; }

  double duration(int clip) const { return At(clip).duration; }  // seconds

  // The handles that it moves, increasing.
  std::span<const int> handles(int clip) const { return At(clip).handles; }

  // The first clip of that name, -1 if there is none.
  int Find(const std::string& name) const;

  // Of one of the clip's handles; before the start and after the end it is as it is there. The
  // handle's rest position moves as if it were fixed to its node, which may stand beside it.
  // Allocates nothing.
  HandlePlace Sample(int clip, int handle, double time) const;

 private:
  // What moves one node: indices into Clip::tracks, -1 none.
  struct NodeTracks {
    int translation = -1, rotation = -1, scale = -1;
  };

  struct Clip {
    std::string name;
    double duration = 0;
    std::vector<int> handles;
    std::vector<KeyframeTrack> tracks;
    std::vector<NodeTracks> of_node;  // [nodes]
  };

  struct Handle {
    int node = -1;
    Eigen::Vector3d rest_position;       // mesh space
    Eigen::Matrix4d rest, inverse_rest;  // node -> mesh space, nothing animated
  };

  const Clip& At(int clip) const { return clips_[static_cast<size_t>(clip)]; }

  void ReadHandles(const Rig& rig, const GltfFile& file);
  Clip MakeClip(AnimationClip from) const;
  // Whether a node on the way from a handle's to the mesh's has such a track; those above both
  // carry both along.
  template <class HasTrack>
  bool AnyBetween(int handle_node, const HasTrack& has_track) const;
  Eigen::Matrix4d WorldAt(const Clip& clip, int node, double time) const;

  std::vector<int> parent_;           // [nodes]
  std::vector<bool> is_above_mesh_;   // [nodes]: the mesh's own node, or one that carries it
  std::vector<NodeTransform> local_;  // [nodes], at rest
  int mesh_node_ = -1;
  std::vector<Handle> handles_;  // [H]
  std::vector<Clip> clips_;
};

}  // namespace limber
