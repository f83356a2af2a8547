#include "gltf_edit/extend_weights.h"

#include "clips/animation_channels.h"
#include "core/vector.h"
#include "load/gltf_accessor.h"

#include <nlohmann/json.hpp>

#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

Status ExtendList(const TargetCounts& counts, const std::string& place, Json* owner) {
  const auto weights = owner->find("weights");
  if (weights == owner->end()) return {};
  if (!weights->is_array() || weights->size() != counts.old_targets) {
    return Error(StatusCode::kMalformed,
                 "%s.weights: it is no list of %zu numbers, one for each morph target; export the "
                 "mesh again",
                 place.c_str(), counts.old_targets);
  }
  for (size_t t = 0; t < counts.new_targets; ++t)
    weights->push_back(0.0);
  return {};
}

// Each `old_targets` numbers are followed by zeros: the value of a keyframe, and its tangents.
Vector<float> WithZeros(const Vector<float>& numbers, const TargetCounts& counts) {
  Vector<float> extended;
  extended.reserve(numbers.size() / counts.old_targets * (counts.old_targets + counts.new_targets));
  for (size_t first = 0; first < numbers.size(); first += counts.old_targets) {
    const auto row = numbers.begin() + static_cast<ptrdiff_t>(first);
    extended.insert(extended.end(), row, row + static_cast<ptrdiff_t>(counts.old_targets));
    extended.resize(extended.size() + counts.new_targets, 0.0f);
  }
  return extended;
}

// The 7 of "/nodes/7/weights", where `section` is "/nodes/".
std::optional<size_t> OwnerInPointer(const std::string& pointer, std::string_view section) {
  if (pointer.rfind(section, 0) != 0) return std::nullopt;
  size_t index = 0;
  const char* const text_end = pointer.data() + pointer.size();
  const auto [end, error] = std::from_chars(pointer.data() + section.size(), text_end, index);
  const bool whole = error == std::errc() && std::string_view(end, text_end) == "/weights";
  return whole ? std::optional(index) : std::nullopt;
}

class WeightAnimations {
 public:
  WeightAnimations(const GltfFile& source, int mesh, const TargetCounts& counts, GltfPatch* patch)
      : source_(source),
        mesh_(mesh),
        counts_(counts),
        patch_(*patch) {}

  Status Extend() {
    for (size_t a = 0; a < NumAnimations(source_); ++a) {
      const Result<Vector<AnimationChannel>> channels = ReadAnimationChannels(source_, a);
      if (!channels.ok()) return channels.status();
      LIMBER_RETURN_IF_ERROR(ReadOutputs(*channels));
      SplitSamplers(a, *channels);
    }
    ReplaceOutputs();
    return {};
  }

 private:
  struct SamplerPlace {
    size_t animation = 0, sampler = 0;
    int output = -1;  // accessor of the source
  };

  bool IsOfMesh(int node) const {
    return source_.json()["nodes"][static_cast<size_t>(node)].value("mesh", -1) == mesh_;
  }

  bool MovesWeights(const AnimationChannel& channel) const {
    if (channel.path == "weights") return channel.node >= 0 && IsOfMesh(channel.node);
    if (OwnerInPointer(channel.pointer, "/meshes/") == static_cast<size_t>(mesh_)) return true;
    const std::optional<size_t> node = OwnerInPointer(channel.pointer, "/nodes/");
    const auto nodes = source_.json().find("nodes");
    return node.has_value() && nodes != source_.json().end() && *node < nodes->size() &&
           IsOfMesh(static_cast<int>(*node));
  }

  Status ReadOutputs(const Vector<AnimationChannel>& channels) {
    for (const AnimationChannel& channel : channels) {
      if (!MovesWeights(channel)) continue;
      if (counts_.old_targets == 0) {
        return Error(StatusCode::kMalformed,
                     "%s: it moves the weights of meshes[%d], which has no morph targets; export "
                     "the animation again",
                     channel.place.c_str(), mesh_);
      }
      AccessorRequest request{channel.output, 1, channel.place + ".output"};
      const int64_t rows = AccessorCount(source_, channel.input) *
                           (channel.interpolation == Interpolation::kCubicSpline ? 3 : 1);
      request.expected_count = rows * static_cast<int64_t>(counts_.old_targets);
      const bool is_known = outputs_.contains(channel.output);
      if (is_known && AccessorCount(source_, channel.output) == request.expected_count) continue;
      const Result<Vector<float>> numbers = ReadFloats(source_, request);
      if (!numbers.ok()) return numbers.status();
      outputs_[channel.output] = WithZeros(*numbers, counts_);
    }
    return {};
  }

  // Notes the samplers that get longer outputs, a copy of those that others need as they are.
  void SplitSamplers(size_t animation, const Vector<AnimationChannel>& channels) {
    std::set<size_t> shared;
    for (const AnimationChannel& channel : channels) {
      if (!MovesWeights(channel)) shared.insert(channel.sampler);
    }
    Json& json = patch_.json()["animations"][animation];
    std::map<size_t, size_t> replacement;
    for (size_t c = 0; c < channels.size(); ++c) {
      const AnimationChannel& channel = channels[c];
      if (!MovesWeights(channel)) continue;
      if (!replacement.contains(channel.sampler)) {
        size_t sampler = channel.sampler;
        if (shared.contains(sampler)) {
          const Json copy = json["samplers"][sampler];
          sampler = json["samplers"].size();
          json["samplers"].push_back(copy);
        }
        replacement[channel.sampler] = sampler;
        samplers_.push_back({animation, sampler, channel.output});
      }
      json["channels"][c]["sampler"] = replacement[channel.sampler];
    }
  }

  // Unlinked first, so that outputs that nobody needs any more make room.
  void ReplaceOutputs() {
    Vector<size_t> old_outputs;
    for (const SamplerPlace& place : samplers_)
      SamplerOf(place).erase("output");
    for (const auto& [output, numbers] : outputs_)
      old_outputs.push_back(static_cast<size_t>(output));
    patch_.RemoveAccessors(old_outputs);
    std::map<int, size_t> added;
    for (const auto& [output, numbers] : outputs_)
      added[output] = patch_.AddFloats("morph target weights", numbers, 1, false);
    for (const SamplerPlace& place : samplers_)
      SamplerOf(place)["output"] = added[place.output];
  }

  Json& SamplerOf(const SamplerPlace& place) {
    return patch_.json()["animations"][place.animation]["samplers"][place.sampler];
  }

  const GltfFile& source_;
  const int mesh_;
  const TargetCounts counts_;
  GltfPatch& patch_;
  std::map<int, Vector<float>> outputs_;  // accessor of the source -> its longer numbers
  Vector<SamplerPlace> samplers_;
};

}  // namespace

Status ExtendWeights(const GltfFile& source, int mesh, const TargetCounts& counts,
                     GltfPatch* patch) {
  Json& root = patch->json();
  const std::string mesh_place = "meshes[" + std::to_string(mesh) + "]";
  LIMBER_RETURN_IF_ERROR(
      ExtendList(counts, mesh_place, &root["meshes"][static_cast<size_t>(mesh)]));
  for (size_t n = 0; root.contains("nodes") && n < root["nodes"].size(); ++n) {
    Json& node = root["nodes"][n];
    if (node.value("mesh", -1) != mesh) continue;
    LIMBER_RETURN_IF_ERROR(ExtendList(counts, "nodes[" + std::to_string(n) + "]", &node));
  }
  return WeightAnimations(source, mesh, counts, patch).Extend();
}

}  // namespace limber::bake
