#include "clips/animation_channels.h"

#include "core/vector.h"
#include "load/json_text.h"

#include <nlohmann/json.hpp>

#include <cstdint>

namespace limber {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kPointerExtension[] = "KHR_animation_pointer";

Status Malformed(const std::string& place, const std::string& reason) {
  return Status(StatusCode::kMalformed, place + ": " + reason + "; export the animation again");
}

size_t Count(const Json& object, const char* section) {
  const auto it = object.find(section);
  return it != object.end() && it->is_array() ? it->size() : 0;
}

Result<int> ReadIndex(const Json& object, const char* key, size_t count, const std::string& place) {
  const auto it = object.find(key);
  if (it == object.end()) return Malformed(place, std::string("\"") + key + "\" is missing");
  if (!it->is_number_unsigned() || it->get<uint64_t>() >= count) {
    return Malformed(place, std::string("\"") + key + "\" is " + ShowJson(*it) + ", there are " +
                                std::to_string(count));
  }
  return static_cast<int>(it->get<uint64_t>());
}

Result<Interpolation> ReadInterpolation(const Json& sampler, const std::string& place) {
  const auto it = sampler.find("interpolation");
  if (it == sampler.end() || *it == "LINEAR") return Interpolation::kLinear;
  if (*it == "STEP") return Interpolation::kStep;
  if (*it == "CUBICSPLINE") return Interpolation::kCubicSpline;
  return Malformed(
      place, "\"interpolation\" is " + ShowJson(*it) + ", known are STEP, LINEAR and CUBICSPLINE");
}

// The pointer of KHR_animation_pointer in a channel's target; empty: it has none.
std::string ReadPointer(const Json& target) {
  const auto extensions = target.find("extensions");
  if (extensions == target.end() || !extensions->is_object()) return {};
  const auto own = extensions->find(kPointerExtension);
  if (own == extensions->end() || !own->is_object()) return {};
  const auto pointer = own->find("pointer");
  return pointer != own->end() && pointer->is_string() ? pointer->get<std::string>()
                                                       : std::string();
}

Status ReadTarget(const GltfFile& file, const Json& json, AnimationChannel* channel) {
  const auto target = json.find("target");
  if (target == json.end() || !target->is_object()) {
    return Malformed(channel->place, "\"target\" is missing");
  }
  const auto path = target->find("path");
  if (path == target->end() || !path->is_string()) {
    return Malformed(channel->place + ".target", "\"path\" is missing");
  }
  channel->path = path->get<std::string>();
  channel->pointer = ReadPointer(*target);
  if (!target->contains("node")) return {};
  const Result<int> node =
      ReadIndex(*target, "node", Count(file.json(), "nodes"), channel->place + ".target");
  if (!node.ok()) return node.status();
  channel->node = *node;
  return {};
}

Status ReadSampler(const GltfFile& file, const Json& animation, const Json& json,
                   const std::string& place, AnimationChannel* channel) {
  const Result<int> sampler =
      ReadIndex(json, "sampler", Count(animation, "samplers"), channel->place);
  if (!sampler.ok()) return sampler.status();
  channel->sampler = static_cast<size_t>(*sampler);
  const Json& entry = animation["samplers"][channel->sampler];
  const std::string sampler_place = place + ".samplers[" + std::to_string(*sampler) + "]";
  if (!entry.is_object()) return Malformed(sampler_place, "not an object");
  const size_t num_accessors = Count(file.json(), "accessors");
  const Result<int> input = ReadIndex(entry, "input", num_accessors, sampler_place);
  if (!input.ok()) return input.status();
  const Result<int> output = ReadIndex(entry, "output", num_accessors, sampler_place);
  if (!output.ok()) return output.status();
  const Result<Interpolation> interpolation = ReadInterpolation(entry, sampler_place);
  if (!interpolation.ok()) return interpolation.status();
  channel->input = *input;
  channel->output = *output;
  channel->interpolation = *interpolation;
  return {};
}

}  // namespace

size_t NumAnimations(const GltfFile& file) {
  return Count(file.json(), "animations");
}

std::string AnimationName(const GltfFile& file, size_t animation) {
  const Json& json = file.json()["animations"][animation];
  const auto name = json.is_object() ? json.find("name") : json.end();
  const bool named = name != json.end() && name->is_string();
  const std::string text = named ? name->get<std::string>() : std::string();
  return text.empty() ? "clip_" + std::to_string(animation) : text;
}

Result<Vector<AnimationChannel>> ReadAnimationChannels(const GltfFile& file, size_t animation) {
  const Json& json = file.json()["animations"][animation];
  const std::string place = "animations[" + std::to_string(animation) + "]";
  if (!json.is_object()) return Malformed(place, "not an object");
  const auto entries = json.find("channels");
  if (entries == json.end() || !entries->is_array()) {
    return Malformed(place, "\"channels\" is not an array");
  }
  Vector<AnimationChannel> channels;
  for (size_t c = 0; c < entries->size(); ++c) {
    AnimationChannel channel;
    channel.place = place + ".channels[" + std::to_string(c) + "]";
    const Json& entry = (*entries)[c];
    if (!entry.is_object()) return Malformed(channel.place, "not an object");
    LIMBER_RETURN_IF_ERROR(ReadTarget(file, entry, &channel));
    LIMBER_RETURN_IF_ERROR(ReadSampler(file, json, entry, place, &channel));
    channels.push_back(std::move(channel));
  }
  return channels;
}

}  // namespace limber
