// The first triangle that a ray meets, each of them looked at: for a click in a game, where nothing
// is kept up to date for it. pick/picker.h is for many rays.
#pragma once

#include "core/vec3.h"
#include "core/vector.h"
#include "ray/triangle_hit.h"

#include <cstdint>
#include <optional>
#include <span>

namespace limber {

struct NearestHit {
  uint32_t triangle = 0;
  TriangleHit at;
};

// Which of several triangles counts that are met at the same distance, to within 1e-6 of it.
enum class EqualHits {
  kFirst,  // the lowest number
  kLast,   // the highest: what lies in one plane is painted in its order
};

class NearestHitFinder {
 public:
  // Memory is kept for the next call. Triangles that share an edge, bit for bit, leave no gap
  // between them; those without area are never met, nor what is behind the origin. positions and
  // origin finite, direction of any finite length but zero; every corner below the number of
  // positions. Both sides count.
  std::optional<NearestHit> Find(std::span<const Vec3> positions,
                                 std::span<const uint32_t> triangles, Vec3 origin, Vec3 direction,
                                 EqualHits equal);

 private:
  // A position as the ray sees it: across it, and along.
  struct Seen {
    double x, y, z;
  };

  Vector<Seen> seen_;
};

}  // namespace limber
