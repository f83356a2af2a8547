#include "clips/animation_clip.h"

#include "core/printable.h"
#include "core/vector.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

std::optional<ClipPath> FindPath(const AnimationChannel& channel) {
  if (channel.node < 0) return std::nullopt;
  if (channel.path == "translation") return ClipPath::kTranslation;
  if (channel.path == "rotation") return ClipPath::kRotation;
  if (channel.path == "scale") return ClipPath::kScale;
  if (channel.path == "weights") return ClipPath::kWeights;
  return std::nullopt;
}

Result<KeyframeTrack> ReadTrack(const GltfFile& file, const AnimationChannel& channel,
                                ClipPath path) {
  if (path == ClipPath::kWeights) {
    const size_t num_targets = NumMorphTargets(file, channel.node);
    if (num_targets == 0) {
      return Error(StatusCode::kMalformed,
                   "%s: it moves the weights of node %d, which has no morph targets; export the "
                   "animation again",
                   channel.place.c_str(), channel.node);
    }
    return ReadKeyframeTrack(file, channel, num_targets, false);
  }
  if (file.json()["nodes"][static_cast<size_t>(channel.node)].contains("matrix")) {
    return Error(StatusCode::kMalformed,
                 "%s: it moves node %d, which has a matrix; only nodes with translation, rotation "
                 "and scale can be animated, export it again",
                 channel.place.c_str(), channel.node);
  }
  return ReadKeyframeTrack(file, channel, path == ClipPath::kRotation ? 4 : 3, true);
}

std::string ListClips(const GltfFile& file) {
  constexpr size_t kMostListed = 24;
  const size_t num_clips = NumAnimations(file);
  std::string list;
  for (size_t a = 0; a < num_clips && a < kMostListed; ++a) {
    list += (a == 0 ? "" : ", ") + Quoted(AnimationName(file, a)) + " (" + std::to_string(a);
    // A clip that cannot be read still stands in the list.
    const Result<AnimationClip> clip = ReadAnimationClip(file, static_cast<int>(a));
    char length[32];
    std::snprintf(length, sizeof length, ", %.3f s", clip.ok() ? clip->duration : 0.0);
    list += clip.ok() ? std::string(length) + ")" : ")";
  }
  return num_clips > kMostListed ? list + ", ..." : list;
}

}  // namespace

size_t NumMorphTargets(const GltfFile& file, int node) {
  const Json& nodes = file.json()["nodes"];
  const auto mesh = nodes[static_cast<size_t>(node)].find("mesh");
  if (mesh == nodes[static_cast<size_t>(node)].end()) return 0;
  size_t most = 0;
  for (const Json& primitive : file.json()["meshes"][mesh->get<size_t>()]["primitives"]) {
    const auto targets = primitive.find("targets");
    if (targets != primitive.end()) most = std::max(most, targets->size());
  }
  return most;
}

Result<int> FindAnimationClip(const GltfFile& file, const std::string& wanted) {
  const size_t num_clips = NumAnimations(file);
  if (num_clips == 0) {
    return Error(StatusCode::kNotFound,
                 "animations: there is none; export the file with its animations");
  }
  if (wanted.empty() && num_clips == 1) return 0;
  if (wanted.empty()) {
    return Error(StatusCode::kInvalidArgument,
                 "animations: there are several; choose one with --clip: %s",
                 ListClips(file).c_str());
  }
  Vector<size_t> matching;
  for (size_t a = 0; a < num_clips; ++a) {
    if (AnimationName(file, a) == wanted) matching.push_back(a);
  }
  if (matching.size() == 1) return static_cast<int>(matching[0]);
  size_t number = 0;
  const char* const text_end = wanted.data() + wanted.size();
  const auto [end, error] = std::from_chars(wanted.data(), text_end, number);
  const bool is_number = error == std::errc() && end == text_end && number < num_clips;
  if (matching.empty() && is_number) return static_cast<int>(number);
  return Error(matching.empty() ? StatusCode::kNotFound : StatusCode::kInvalidArgument,
               "clip %s: %s; the file has %s", Quoted(wanted).c_str(),
               matching.empty() ? "there is none of that name or number"
                                : "several have that name, give a number",
               ListClips(file).c_str());
}

Result<AnimationClip> ReadAnimationClip(const GltfFile& file, int animation) {
  const auto index = static_cast<size_t>(animation);
  const Result<Vector<AnimationChannel>> channels = ReadAnimationChannels(file, index);
  if (!channels.ok()) return channels.status();
  AnimationClip clip;
  clip.index = animation;
  clip.name = AnimationName(file, index);
  for (const AnimationChannel& channel : *channels) {
    const std::optional<ClipPath> path = FindPath(channel);
    if (!path.has_value()) continue;
    Result<KeyframeTrack> track = ReadTrack(file, channel, *path);
    if (!track.ok()) return track.status();
    clip.duration = std::max(clip.duration, track->times.back());
    clip.channels.push_back({channel.node, *path, std::move(*track)});
  }
  return clip;
}

void ApplyClip(const AnimationClip& clip, double time, Vector<NodeTransform>* local) {
  for (const ClipChannel& channel : clip.channels) {
    if (channel.path == ClipPath::kWeights) continue;
    NodeTransform& node = (*local)[static_cast<size_t>(channel.node)];
    if (channel.path == ClipPath::kRotation) {
      node.rotation = SampleRotation(channel.track, time);
      continue;
    }
    std::array<double, 3> value{};
    SampleTrack(channel.track, time, value);
    Eigen::Vector3d& moved = channel.path == ClipPath::kTranslation ? node.translation : node.scale;
    moved = Eigen::Vector3d(value[0], value[1], value[2]);
  }
}

void ApplyClipWeights(const AnimationClip& clip, double time, int node, Vector<double>* weights) {
  for (const ClipChannel& channel : clip.channels) {
    if (channel.path == ClipPath::kWeights && channel.node == node) {
      *weights = SampleTrack(channel.track, time);
    }
  }
}

}  // namespace limber
