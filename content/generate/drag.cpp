#include "generate/drag.h"

#include "generate/shaping.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace limber::content {
namespace {

using Json = nlohmann::ordered_json;
using Targets = std::vector<Vector3d>;  // one per handle of the character

Targets TargetsAt(const Character& character, const DragStop& stop) {
  const std::vector<Vector3d>& rest = character.shapes.at(0).positions;
  const auto shape = std::find_if(character.shapes.begin(), character.shapes.end(),
                                  [&](const Shape& s) { return s.name == stop.shape; });
  Targets targets;
  for (const Handle& handle : character.handles) {
    const bool named = stop.handles.empty() ||
                       std::count(stop.handles.begin(), stop.handles.end(), handle.name) > 0;
    const double amount = named && shape != character.shapes.end() ? stop.amount : 0;
    const Vector3d& from = rest[handle.vertex];
    const Vector3d& to = amount != 0 ? shape->positions[handle.vertex] : from;
    targets.emplace_back(from + amount * (to - from));
  }
  return targets;
}

Json Frame(const Character& character, const Targets& targets) {
  Json frame;
  for (size_t h = 0; h < targets.size(); ++h) {
    if (!character.handles[h].pinned) continue;
    Json& place = frame["targets"][character.handles[h].name];
    for (int c = 0; c < 3; ++c)
      place.push_back(std::round(targets[h][c] * 1e5) / 1e5 + 0.0);
  }
  return frame;
}

}  // namespace

std::string WriteDrag(const Character& character, const std::vector<DragStop>& stops) {
  Targets from = TargetsAt(character, {});
  std::string text = "{\"frames\": [";
  const char* separator = "\n";
  for (const DragStop& stop : stops) {
    const Targets to = TargetsAt(character, stop);
    for (int f = 1; f <= stop.frames; ++f) {
      const double t = SmoothStep(0, 1, double(f) / stop.frames);
      Targets targets = from;
      for (size_t h = 0; h < targets.size(); ++h)
        targets[h] += t * (to[h] - from[h]);
      text += separator + Frame(character, targets).dump();
      separator = ",\n";
    }
    from = to;
  }
  return text + "\n]}\n";
}

}  // namespace limber::content
