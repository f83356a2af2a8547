#include "generate/drag.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::content {
namespace {

using Json = nlohmann::ordered_json;
using Targets = std::vector<Vector3d>;  // one per handle of the character

// From 0 to 1 as s does, at rest at both ends, and a little beyond 1 before the end.
double Ease(double s) {
  constexpr double kArrival = 0.85, kOvershoot = 0.05, kPi = std::numbers::pi;
  const double rise = 0.5 - 0.5 * std::cos(kPi * std::min(s / kArrival, 1.0));
  const double late = std::sin(kPi * std::clamp(2 * s - 1, 0.0, 1.0));
  return rise + kOvershoot * late * late;
}

GestureMix Between(const GestureMix& from, const GestureMix& to, double t) {
  GestureMix mix;
  for (const GestureAmount& part : from)
    mix.push_back({part.gesture, (1 - t) * part.amount});
  for (const GestureAmount& part : to)
    mix.push_back({part.gesture, t * part.amount});
  return mix;
}

class Director {
 public:
  Director(const Character& character, const Posing& posing)
      : character_(character),
        posing_(posing) {
    for (size_t s = 0; s < character.shapes.size(); ++s)
      off_.push_back(Off(s));
  }

  Targets At(const GestureMix& mix) const {
    const SpaceWarp pose = posing_(mix);
    Targets targets;
    for (size_t h = 0; h < character_.handles.size(); ++h) {
      Vector3d off = off_[0][h];
      for (size_t s = 1; s < character_.shapes.size(); ++s)
        off += AmountOf(character_.shapes[s].name, mix) * (off_[s][h] - off_[0][h]);
      targets.emplace_back(pose(Place(0, h)) + off);
    }
    return targets;
  }

 private:
  const Vector3d& Place(size_t shape, size_t handle) const {
    return character_.shapes[shape].positions[character_.handles[handle].vertex];
  }

  // How far the handles of an example shape are from where the posing takes them: shapes are
  // smoothed once they are posed.
  Targets Off(size_t shape) const {
    const SpaceWarp pose = posing_({{character_.shapes[shape].name, 1}});
    Targets off;
    for (size_t h = 0; h < character_.handles.size(); ++h)
      off.emplace_back(Place(shape, h) - pose(Place(0, h)));
    return off;
  }

  const Character& character_;
  const Posing& posing_;
  std::vector<Targets> off_;  // of all shapes
};

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

std::string WriteDrag(const Character& character, const Posing& posing,
                      const std::vector<DragStop>& stops) {
  const Director director(character, posing);
  GestureMix from;
  std::string text = "{\"frames\": [";
  const char* separator = "\n";
  for (const DragStop& stop : stops) {
    for (int f = 1; f <= stop.frames; ++f) {
      const GestureMix mix = Between(from, stop.mix, Ease(double(f) / stop.frames));
      text += separator + Frame(character, director.At(mix)).dump();
      separator = ",\n";
    }
    from = stop.mix;
  }
  return text + "\n]}\n";
}

}  // namespace limber::content
