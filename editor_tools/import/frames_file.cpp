#include "import/frames_file.h"

#include "import/json_input.h"

#include <nlohmann/json.hpp>

namespace limber::bake {
namespace {

std::string TargetPlace(const std::string& frame, const std::string& handle) {
  return frame + ".targets: \"" + handle + "\"";
}

using Json = nlohmann::ordered_json;

Result<FrameTargets> ReadFrame(const Json& frame, const std::string& place) {
  LIMBER_RETURN_IF_ERROR(CheckMembers(frame, place, {"targets"}));
  const auto targets = frame.find("targets");
  FrameTargets result;
  if (targets == frame.end()) return result;
  if (!targets->is_object()) {
    return Status(StatusCode::kMalformed,
                  place + ".targets: an object of handle names and positions is needed");
  }
  for (const auto& [name, value] : targets->items()) {
    Result<Vec3> point = ReadPoint(value, TargetPlace(place, name));
    if (!point.ok()) return point.status();
    result.emplace_back(name, *point);
  }
  return result;
}

}  // namespace

Result<std::vector<FrameTargets>> ParseFrames(std::string_view text, const std::string& name) {
  Result<Json> root = ParseInput(text, name);
  if (!root.ok()) return root.status();
  LIMBER_RETURN_IF_ERROR(CheckMembers(*root, "the root", {"frames"}).WithContext(name));
  const auto frames = root->find("frames");
  if (frames == root->end() || !frames->is_array() || frames->empty()) {
    return Error(StatusCode::kMalformed, "%s: frames: a list of one frame or more is needed",
                 name.c_str());
  }
  std::vector<FrameTargets> result;
  for (size_t f = 0; f < frames->size(); ++f) {
    Result<FrameTargets> frame = ReadFrame((*frames)[f], "frames[" + std::to_string(f) + "]");
    if (!frame.ok()) return frame.status().WithContext(name);
    result.push_back(std::move(*frame));
  }
  return result;
}

Result<std::vector<FrameTargets>> ReadFramesFile(const std::filesystem::path& path) {
  Result<std::string> text = ReadTextFile(path);
  if (!text.ok()) return text.status();
  return ParseFrames(*text, path.string());
}

}  // namespace limber::bake
