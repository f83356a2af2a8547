#include "generate/character.h"

#include <cmath>
#include <limits>

namespace limber::content {

uint32_t NearestVertex(const Character& character, const Vector3d& position) {
  uint32_t nearest = 0;
  double smallest = std::numeric_limits<double>::infinity();
  const std::vector<Vector3d>& rest = character.shapes.at(0).positions;
  for (uint32_t v = 0; v < rest.size(); ++v) {
    const double distance = (rest[v] - position).squaredNorm();
    if (distance < smallest) {
      smallest = distance;
      nearest = v;
    }
  }
  return nearest;
}

void RoundPositions(Character* character) {
  constexpr double kGrid = 65536;
  for (Shape& shape : character->shapes) {
    for (Vector3d& p : shape.positions) {
      // The sum with +0 turns a negative zero into a positive one.
      p = (p * kGrid).array().round() / kGrid + 0.0;
    }
  }
}

}  // namespace limber::content
