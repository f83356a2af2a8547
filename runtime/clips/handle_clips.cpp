#include "clips/handle_clips.h"

#include "clips/animation_channels.h"
#include "core/out_of_memory.h"
#include "core/vector.h"
#include "load/rig_loader.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <map>

namespace limber {
namespace {

// A hostile file must not make a second's work of each of a million clips.
constexpr size_t kMostClips = 1024;
constexpr int kMostNodesAbove = 256;

constexpr double kSmallestDeterminant = 1e-12;  // of a node's transform that can be undone

Eigen::Matrix4d Inverse(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix4d inverse = matrix.inverse();
  const bool exists = std::abs(matrix.topLeftCorner<3, 3>().determinant()) > kSmallestDeterminant &&
                      inverse.allFinite();
  return exists ? inverse : Eigen::Matrix4d::Identity();
}

// A node counts only if it has the handle's name: a tool that renumbers nodes must not make a
// stranger of it.
bool HasName(const GltfFile& file, int node, std::string_view name) {
  const auto& nodes = file.json()["nodes"];
  const auto& json = nodes[static_cast<size_t>(node)];
  const auto found = json.find("name");
  return found != json.end() && found->is_string() && found->get_ref<const std::string&>() == name;
}

}  // namespace

Result<std::shared_ptr<const HandleClips>> HandleClips::Read(const GltfFile& file, const Rig& rig,
                                                             int rig_index,
                                                             Vector<std::string>* warnings) {
  using Shared = std::shared_ptr<const HandleClips>;
  return CatchOutOfMemory("clips", [&]() -> Result<Shared> {
    auto clips = MakeShared<HandleClips>();
    clips->mesh_node_ = FindRigNode(file, rig_index);
    if (clips->mesh_node_ < 0)
      return Error(StatusCode::kInvalidArgument, "clips: no node carries rig %d", rig_index);
    clips->ReadHandles(rig, file, warnings);
    for (size_t a = 0; a < NumAnimations(file); ++a) {
      if (clips->clips_.size() == kMostClips) {
        warnings->push_back(file.name() + ": animations: only the first 1024 that move a handle");
        break;
      }
      Result<AnimationClip> clip = ReadAnimationClip(file, static_cast<int>(a));
      if (clip.status().code() == StatusCode::kOutOfMemory) return clip.status();
      if (!clip.ok()) {
        warnings->push_back(file.name() + ": " + clip.status().message());
        continue;
      }
      Clip made = clips->MakeClip(std::move(clip).value());
      if (!made.handles.empty()) clips->clips_.push_back(std::move(made));
    }
    return Shared(std::move(clips));
  });
}

bool HandleClips::IsShallow(int node) const {
  int depth = 0;
  for (; node >= 0 && depth <= kMostNodesAbove; ++depth)
    node = parent_[static_cast<size_t>(node)];
  return depth <= kMostNodesAbove;
}

void HandleClips::ReadHandles(const Rig& rig, const GltfFile& file, Vector<std::string>* warnings) {
  parent_ = ParentNodes(file);
  local_ = LocalTransforms(file);
  is_above_mesh_.resize(parent_.size(), false);
  for (int node = mesh_node_; node >= 0; node = parent_[static_cast<size_t>(node)])
    is_above_mesh_[static_cast<size_t>(node)] = true;
  matters_ = is_above_mesh_;
  const Vector<Eigen::Matrix4d> world = WorldTransforms(file);
  const Eigen::Matrix4d mesh_from_world = Inverse(world[static_cast<size_t>(mesh_node_)]);
  for (const RigHandle& from : rig.tables().handles) {
    const Vec3 rest = from.rest_position;
    Handle handle;
    handle.rest_position = Eigen::Vector3d(rest.x, rest.y, rest.z);
    const bool in_file = from.node >= 0 && static_cast<size_t>(from.node) < parent_.size() &&
                         HasName(file, from.node, from.name);
    if (in_file && IsShallow(from.node) && IsShallow(mesh_node_)) {
      handle.node = from.node;
      handle.node_from_mesh = Inverse(mesh_from_world * world[static_cast<size_t>(from.node)]);
      for (int node = from.node; node >= 0; node = parent_[static_cast<size_t>(node)])
        matters_[static_cast<size_t>(node)] = true;
    } else if (in_file) {
      warnings->push_back(file.name() + ": node " + std::to_string(from.node) +
                          ": more than 256 nodes are above it or the mesh; nothing animates it");
    }
    handles_.push_back(handle);
  }
}

const HandleClips::NodeTracks* HandleClips::FindTracks(const Clip& clip, int node) {
  const auto found =
      std::lower_bound(clip.moved.begin(), clip.moved.end(), node,
                       [](const NodeTracks& tracks, int wanted) { return tracks.node < wanted; });
  return found != clip.moved.end() && found->node == node ? &*found : nullptr;
}

template <class Has>
bool HandleClips::AnyBetween(const Clip& clip, int handle_node, const Has& has) const {
  const auto is_moved = [&](int node) {
    const NodeTracks* tracks = FindTracks(clip, node);
    return tracks != nullptr && has(*tracks);
  };
  int common = handle_node;  // the first node above both, or none
  for (; common >= 0 && !is_above_mesh_[static_cast<size_t>(common)];
       common = parent_[static_cast<size_t>(common)]) {
    if (is_moved(common)) return true;
  }
  for (int node = mesh_node_; node != common; node = parent_[static_cast<size_t>(node)]) {
    if (is_moved(node)) return true;
  }
  return false;
}

HandleClips::Clip HandleClips::MakeClip(AnimationClip from) const {
  Clip clip;
  clip.name.assign(from.name);
  clip.duration = from.duration;
  std::map<int, NodeTracks> moved;
  for (ClipChannel& channel : from.channels) {
    if (channel.path == ClipPath::kWeights || !matters_[static_cast<size_t>(channel.node)])
      continue;
    NodeTracks& tracks = moved[channel.node];
    tracks.node = channel.node;
    int& track = channel.path == ClipPath::kTranslation ? tracks.translation
                 : channel.path == ClipPath::kRotation  ? tracks.rotation
                                                        : tracks.scale;
    track = static_cast<int>(clip.tracks.size());
    clip.tracks.push_back(std::move(channel.track));
  }
  if (moved.empty()) return clip;
  for (const auto& [node, tracks] : moved)
    clip.moved.push_back(tracks);
  for (size_t h = 0; h < handles_.size(); ++h) {
    const int node = handles_[h].node;
    if (node < 0 || !AnyBetween(clip, node, [](const NodeTracks&) { return true; })) continue;
    const bool is_turned =
        AnyBetween(clip, node, [](const NodeTracks& tracks) { return tracks.rotation >= 0; });
    clip.handles.push_back({static_cast<int>(h), is_turned});
  }
  return clip;
}

int HandleClips::Find(std::string_view name) const {
  for (size_t c = 0; c < clips_.size(); ++c) {
    if (clips_[c].name == name) return static_cast<int>(c);
  }
  return -1;
}

Eigen::Matrix4d HandleClips::WorldAt(const Clip& clip, int node, double time) const {
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
  for (; node >= 0; node = parent_[static_cast<size_t>(node)]) {
    NodeTransform local = local_[static_cast<size_t>(node)];
    const NodeTracks none, *found = FindTracks(clip, node);
    const NodeTracks& tracks = found == nullptr ? none : *found;
    std::array<double, 3> value{};
    if (tracks.translation >= 0) {
      SampleTrack(clip.tracks[static_cast<size_t>(tracks.translation)], time, value);
      local.translation = Eigen::Vector3d(value[0], value[1], value[2]);
    }
    if (tracks.rotation >= 0)
      local.rotation = SampleRotation(clip.tracks[static_cast<size_t>(tracks.rotation)], time);
    if (tracks.scale >= 0) {
      SampleTrack(clip.tracks[static_cast<size_t>(tracks.scale)], time, value);
      local.scale = Eigen::Vector3d(value[0], value[1], value[2]);
    }
    world = local.Matrix() * world;
  }
  return world;
}

HandleClips::Moment HandleClips::MomentOf(int clip, double time) const {
  return {clip, time, Inverse(WorldAt(At(clip), mesh_node_, time))};
}

HandlePlace HandleClips::Sample(const Moment& moment, const ClipHandle& clip_handle) const {
  const Handle& handle = handles_[static_cast<size_t>(clip_handle.handle)];
  const Eigen::Matrix4d world = WorldAt(At(moment.clip), handle.node, moment.time);
  Eigen::Affine3d moved;
  moved.matrix() = moment.mesh_from_world * world * handle.node_from_mesh;
  const Eigen::Vector3f position = (moved * handle.rest_position).cast<float>();
  HandlePlace place;
  place.position = {position[0], position[1], position[2]};
  if (!clip_handle.is_turned) return place;
  const Eigen::Quaternionf q(Eigen::Quaterniond(moved.rotation()).cast<float>());
  place.rotation = {q.x(), q.y(), q.z(), q.w()};
  return place;
}

}  // namespace limber
