#include "drive/reach.h"

#include <cmath>

namespace limber {
namespace {

constexpr int kMostRounds = 200;
constexpr double kTolerance = 1e-6;  // of the radius

struct Point {
  double x = 0, y = 0, z = 0;
};

// Whether it was outside by more than the tolerance.
bool PullIntoBall(Vec3 centre, double radius, Point* p) {
  const Point d = {p->x - centre.x, p->y - centre.y, p->z - centre.z};
  const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
  if (length <= radius) return false;
  const double s = radius / length;
  *p = {centre.x + s * d.x, centre.y + s * d.y, centre.z + s * d.z};
  return length > (1 + kTolerance) * radius;
}

}  // namespace

// Projections onto the balls in turn end in their intersection. Each of them brings no two points
// further apart, nor does their limit: the result jumps nowhere.
Vec3 ClampToReach(const PoseState& state, int handle, double limit, Vec3 goal) {
  const RigTables& tables = state.rig().tables();
  if (tables.handle_reach.empty() || !(limit > 0)) return goal;
  const auto num_handles = static_cast<size_t>(tables.num_handles());
  const float* reach = tables.handle_reach.data() + static_cast<size_t>(handle) * num_handles;
  const double scale = limit * static_cast<double>(tables.space.scale);
  Point p = {goal.x, goal.y, goal.z};
  bool is_inside = false;
  for (int round = 0; round < kMostRounds && !is_inside; ++round) {
    is_inside = true;
    for (size_t other = 0; other < num_handles; ++other) {
      const auto h = static_cast<int>(other);
      if (h == handle || reach[other] <= 0 || !state.is_pinned(h)) continue;
      const double radius = scale * static_cast<double>(reach[other]);
      is_inside &= !PullIntoBall(state.target(h), radius, &p);
    }
  }
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

}  // namespace limber
