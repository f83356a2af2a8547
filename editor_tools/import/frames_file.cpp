#include "import/frames_file.h"

#include "core/vector.h"
#include "import/json_input.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace limber::bake {
namespace {

using Json = nlohmann::ordered_json;

Status ReadPinned(const Json& value, const std::string& place, HandleInput* input) {
  if (!value.is_boolean())
    return Status(StatusCode::kMalformed, place + ": neither true nor false");
  input->pinned = value.get<bool>();
  return {};
}

// A number above zero; null: infinity, which means what `null_means` says.
Status ReadPositive(const Json& value, const std::string& place, const char* null_means,
                    std::optional<float>* number) {
  *number = std::numeric_limits<float>::infinity();
  if (value.is_null()) return {};
  const double read = value.is_number() ? value.get<double>() : -1;
  if (!(read > 0) || !std::isfinite(static_cast<float>(read))) {
    return Status(StatusCode::kMalformed,
                  place + ": a number above zero is needed, or null for " + null_means);
  }
  *number = static_cast<float>(read);
  return {};
}

Status ReadStiffness(const Json& value, const std::string& place, HandleInput* input) {
  return ReadPositive(value, place, "exactly", &input->stiffness);
}

Status ReadWeight(const Json& value, const std::string& place, HandleInput* input) {
  return ReadPositive(value, place, "never giving way", &input->weight);
}

Status ReadTarget(const Json& value, const std::string& place, HandleInput* input) {
  const Result<Vec3> point = ReadPoint(value, place);
  if (!point.ok()) return point.status();
  input->target = *point;
  return {};
}

Status ReadRotation(const Json& value, const std::string& place, HandleInput* input) {
  input->clears_rotation = value.is_null();
  if (value.is_null()) return {};
  float parts[4] = {};
  bool sound = value.is_array() && value.size() == 4;
  for (size_t i = 0; sound && i < 4; ++i) {
    sound = value[i].is_number() && std::abs(value[i].get<double>()) <= 1e15;
    if (sound) parts[i] = value[i].get<float>();
  }
  if (!sound) {
    return Status(StatusCode::kMalformed,
                  place + ": a quaternion of four numbers x, y, z, w is needed, or null for none");
  }
  input->rotation = Quaternion{parts[0], parts[1], parts[2], parts[3]};
  return {};
}

struct Member {
  const char* name;
  const char* values;
  Status (*read)(const Json& value, const std::string& place, HandleInput* input);
};

constexpr Member kMembers[] = {{"pinned", "true or false", ReadPinned},
                               {"stiffness", "numbers", ReadStiffness},
                               {"weights", "numbers", ReadWeight},
                               {"targets", "positions", ReadTarget},
                               {"rotations", "quaternions", ReadRotation}};

// What one member of a frame says of its handles, at the end of `frame`.
Status ReadMember(const Member& member, const Json& values, const std::string& place,
                  FrameInput* frame) {
  if (!values.is_object()) {
    return Status(StatusCode::kMalformed,
                  place + ": an object of handle names and " + member.values + " is needed");
  }
  for (const auto& [name, value] : values.items()) {
    HandleInput input;
    input.handle = name;
    std::string handle_place = place;
    handle_place.append(": \"").append(name).append("\"");
    LIMBER_RETURN_IF_ERROR(member.read(value, handle_place, &input));
    frame->push_back(std::move(input));
  }
  return {};
}

Result<FrameInput> ReadFrame(const Json& frame, const std::string& place) {
  LIMBER_RETURN_IF_ERROR(
      CheckMembers(frame, place, {"targets", "pinned", "stiffness", "weights", "rotations"}));
  FrameInput result;
  for (const Member& member : kMembers) {
    const auto found = frame.find(member.name);
    if (found == frame.end()) continue;
    LIMBER_RETURN_IF_ERROR(ReadMember(member, *found, place + "." + member.name, &result));
  }
  return result;
}

}  // namespace

Result<Vector<FrameInput>> ParseFrames(std::string_view text, const std::string& name) {
  Result<Json> root = ParseInput(text, name);
  if (!root.ok()) return root.status();
  LIMBER_RETURN_IF_ERROR(CheckMembers(*root, "the root", {"frames"}).WithContext(name));
  const auto frames = root->find("frames");
  if (frames == root->end() || !frames->is_array() || frames->empty()) {
    return Error(StatusCode::kMalformed, "%s: frames: a list of one frame or more is needed",
                 name.c_str());
  }
  Vector<FrameInput> result;
  for (size_t f = 0; f < frames->size(); ++f) {
    Result<FrameInput> frame = ReadFrame((*frames)[f], "frames[" + std::to_string(f) + "]");
    if (!frame.ok()) return frame.status().WithContext(name);
    result.push_back(std::move(*frame));
  }
  return result;
}

Result<Vector<FrameInput>> ReadFramesFile(const std::filesystem::path& path) {
  Result<std::string> text = ReadTextFile(path);
  if (!text.ok()) return text.status();
  return ParseFrames(*text, path.string());
}

}  // namespace limber::bake
