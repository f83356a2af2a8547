#include "clips/handle_clips.h"

#include "clips/animation_channels.h"
#include "core/out_of_memory.h"
#include "load/rig_loader.h"

#include <nlohmann/json.hpp>

namespace limber {
namespace {

constexpr double kSmallestDeterminant = 1e-12;  // of a node's transform that can be undone

Eigen::Matrix4d Inverse(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix4d inverse = matrix.inverse();
  const bool exists = std::abs(matrix.topLeftCorner<3, 3>().determinant()) > kSmallestDeterminant &&
                      inverse.allFinite();
  return exists ? inverse : Eigen::Matrix4d::Identity();
}

// A node counts only if it has the handle's name: a tool that renumbers nodes must not make a
// stranger of it.
bool HasName(const GltfFile& file, int node, const std::string& name) {
  const auto& nodes = file.json()["nodes"];
  const auto& json = nodes[static_cast<size_t>(node)];
  const auto found = json.find("name");
  return found != json.end() && *found == name;
}

}  // namespace

Result<std::shared_ptr<const HandleClips>> HandleClips::Read(const GltfFile& file, const Rig& rig,
                                                             int rig_index,
                                                             std::vector<std::string>* warnings) {
  using Shared = std::shared_ptr<const HandleClips>;
  return CatchOutOfMemory("clips", [&]() -> Result<Shared> {
    auto clips = std::make_shared<HandleClips>();
    clips->mesh_node_ = FindRigNode(file, rig_index);
    if (clips->mesh_node_ < 0)
      return Error(StatusCode::kInvalidArgument, "clips: no node carries rig %d", rig_index);
    clips->ReadHandles(rig, file);
    for (size_t a = 0; a < NumAnimations(file); ++a) {
      Result<AnimationClip> clip = ReadAnimationClip(file, static_cast<int>(a));
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

void HandleClips::ReadHandles(const Rig& rig, const GltfFile& file) {
  parent_ = ParentNodes(file);
  local_ = LocalTransforms(file);
  is_above_mesh_.resize(parent_.size(), false);
  for (int node = mesh_node_; node >= 0; node = parent_[static_cast<size_t>(node)])
    is_above_mesh_[static_cast<size_t>(node)] = true;
  const std::vector<Eigen::Matrix4d> world = WorldTransforms(file);
  const Eigen::Matrix4d to_mesh = Inverse(world[static_cast<size_t>(mesh_node_)]);
  for (const RigHandle& from : rig.tables().handles) {
    Handle handle;
    const Vec3 rest = from.rest_position;
    handle.rest_position = Eigen::Vector3d(rest.x, rest.y, rest.z);
    const bool in_file = from.node >= 0 && static_cast<size_t>(from.node) < parent_.size();
    if (in_file && HasName(file, from.node, from.name)) {
      handle.node = from.node;
      handle.rest = to_mesh * world[static_cast<size_t>(from.node)];
      handle.inverse_rest = Inverse(handle.rest);
    }
    handles_.push_back(handle);
  }
}

template <class HasTrack>
bool HandleClips::AnyBetween(int handle_node, const HasTrack& has_track) const {
  int common = handle_node;  // the first node above both, or none
  for (; common >= 0 && !is_above_mesh_[static_cast<size_t>(common)];
       common = parent_[static_cast<size_t>(common)]) {
    if (has_track(static_cast<size_t>(common))) return true;
  }
  for (int node = mesh_node_; node != common; node = parent_[static_cast<size_t>(node)]) {
    if (has_track(static_cast<size_t>(node))) return true;
  }
  return false;
}

HandleClips::Clip HandleClips::MakeClip(AnimationClip from) const {
  Clip clip;
  clip.name = std::move(from.name);
  clip.duration = from.duration;
  clip.of_node.resize(parent_.size());
  for (ClipChannel& channel : from.channels) {
    if (channel.path == ClipPath::kWeights) continue;
    NodeTracks& tracks = clip.of_node[static_cast<size_t>(channel.node)];
    int& track = channel.path == ClipPath::kTranslation ? tracks.translation
                 : channel.path == ClipPath::kRotation  ? tracks.rotation
                                                        : tracks.scale;
    track = static_cast<int>(clip.tracks.size());
    clip.tracks.push_back(std::move(channel.track));
  }
  for (size_t h = 0; h < handles_.size(); ++h) {
    const bool moves =
        handles_[h].node >= 0 && AnyBetween(handles_[h].node, [&](size_t node) {
          const NodeTracks& tracks = clip.of_node[node];
          return tracks.translation >= 0 || tracks.rotation >= 0 || tracks.scale >= 0;
        });
    if (moves) clip.handles.push_back(static_cast<int>(h));
  }
  return clip;
}

int HandleClips::Find(const std::string& name) const {
  for (size_t c = 0; c < clips_.size(); ++c) {
    if (clips_[c].name == name) return static_cast<int>(c);
  }
  return -1;
}

Eigen::Matrix4d HandleClips::WorldAt(const Clip& clip, int node, double time) const {
  Eigen::Matrix4d world = Eigen::Matrix4d::Identity();
  for (; node >= 0; node = parent_[static_cast<size_t>(node)]) {
    const NodeTracks& tracks = clip.of_node[static_cast<size_t>(node)];
    NodeTransform local = local_[static_cast<size_t>(node)];
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

HandlePlace HandleClips::Sample(int clip_index, int handle_index, double time) const {
  const Clip& clip = At(clip_index);
  const Handle& handle = handles_[static_cast<size_t>(handle_index)];
  const Eigen::Matrix4d now =
      Inverse(WorldAt(clip, mesh_node_, time)) * WorldAt(clip, handle.node, time);
  const Eigen::Matrix4d moved = now * handle.inverse_rest;
  HandlePlace place;
  const Eigen::Vector3d position =
      moved.topLeftCorner<3, 3>() * handle.rest_position + moved.topRightCorner<3, 1>();
  place.position = {static_cast<float>(position[0]), static_cast<float>(position[1]),
                    static_cast<float>(position[2])};
  place.is_turned =
      AnyBetween(handle.node, [&](size_t node) { return clip.of_node[node].rotation >= 0; });
  if (!place.is_turned) return place;
  Eigen::Affine3d affine;
  affine.matrix() = moved;
  const Eigen::Quaterniond q(affine.rotation());
  place.rotation = {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                    static_cast<float>(q.w())};
  return place;
}

}  // namespace limber
