// A file's own animations as far as they move a rig's handles against its mesh: channels on the
// handles' nodes, on nodes above them, or on the mesh's (handles then stay where they are while the
// mesh moves on). Sampled in mesh space. Immutable; any number of threads.
#pragma once

#include "clips/animation_clip.h"
#include "clips/node_transforms.h"
#include "core/quaternion.h"
#include "core/status.h"
#include "core/vector.h"
#include "load/gltf_file.h"
#include "rig/rig.h"

#include <memory>
#include <span>
#include <string>

namespace limber {

// Where a clip has a handle at a moment; mesh space.
struct HandlePlace {
  Vec3 position;
  Quaternion rotation;  // from rest; the identity where the clip turns nothing
};

// A handle that a clip moves.
struct ClipHandle {
  int handle = -1;
  bool is_turned = false;  // it has rotations
};

class HandleClips {
 public:
  // Clips that move no handle are left out, and so are those that cannot be read: each of these is
  // named in a line of `warnings`, as is what exceeds a limit (256 nodes above the mesh or a
  // handle, 1024 clips). Errors: kInvalidArgument (no such rig), kOutOfMemory.
  static Result<std::shared_ptr<const HandleClips>> Read(const GltfFile& file, const Rig& rig,
                                                         int rig_index,
                                                         Vector<std::string>* warnings);

  int num_clips() const { return static_cast<int>(clips_.size()); }

  const String& name(int clip) const { return At(clip).name; }

  double duration(int clip) const { return At(clip).duration; }  // seconds

  // The handles that it moves, increasing.
  std::span<const ClipHandle> handles(int clip) const { return At(clip).handles; }

  // The first clip of that name, -1 if there is none.
  int Find(std::string_view name) const;

  // A clip at one moment: what all handles have in common there.
  struct Moment {
    int clip = 0;
    double time = 0;
    Eigen::Matrix4d mesh_from_world;
  };

  // Before the start and after the end a clip is as it is there. Allocates nothing.
  Moment MomentOf(int clip, double time) const;

  // Of one of the clip's handles. Its rest position moves as if it were fixed to its node, which
  // may stand beside it. Allocates nothing.
  HandlePlace Sample(const Moment& moment, const ClipHandle& handle) const;

 private:
  // What moves one node: indices into Clip::tracks, -1 none.
  struct NodeTracks {
    int node = -1;
    int translation = -1, rotation = -1, scale = -1;
  };

  struct Clip {
    String name;
    double duration = 0;
    Vector<ClipHandle> handles;
    Vector<KeyframeTrack> tracks;
    Vector<NodeTracks> moved;  // by node
  };

  struct Handle {
    int node = -1;                   // -1: nothing animates it
    Eigen::Vector3d rest_position;   // mesh space
    Eigen::Matrix4d node_from_mesh;  // nothing animated
  };

  const Clip& At(int clip) const { return clips_[static_cast<size_t>(clip)]; }

  void ReadHandles(const Rig& rig, const GltfFile& file, Vector<std::string>* warnings);
  Clip MakeClip(AnimationClip from) const;
  // Whether a node on the way from a handle's to the mesh's has such tracks; those above both carry
  // both along.
  template <class Has>
  bool AnyBetween(const Clip& clip, int handle_node, const Has& has) const;
  bool IsShallow(int node) const;
  static const NodeTracks* FindTracks(const Clip& clip, int node);
  Eigen::Matrix4d WorldAt(const Clip& clip, int node, double time) const;

  Vector<int> parent_;           // [nodes]
  Vector<bool> is_above_mesh_;   // [nodes]: the mesh's own node, or one that carries it
  Vector<bool> matters_;         // [nodes]: those, and handles' nodes and what carries them
  Vector<NodeTransform> local_;  // [nodes], at rest
  int mesh_node_ = -1;
  Vector<Handle> handles_;  // [H]
  Vector<Clip> clips_;
};

}  // namespace limber
