#include "geometry/tufted_cover.h"

#include "core/vector.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace limber::geometry {
namespace {

using Triangle = std::array<int, 3>;

// One side of one triangle, at the edge low < high.
struct Side {
  int low = 0, high = 0;
  int triangle = 0, side = 0;
};

bool SameEdge(const Side& a, const Side& b) {
  return a.low == b.low && a.high == b.high;
}

Vector<Side> SidesByEdge(std::span<const Triangle> triangles) {
  Vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangles[t][i], triangles[t][(i + 1) % 3]);
      sides.push_back({low, high, static_cast<int>(t), i});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

// Puts the sides at one edge into their order around it, counter-clockwise seen from `high`.
class AroundEdge {
 public:
  AroundEdge(const PointMatrix& points, std::span<const Triangle> triangles)
      : points_(points),
        triangles_(triangles) {}

  void Sort(std::span<Side> sides) {
    const Eigen::Vector3d origin = points_.row(sides[0].low);
    const Eigen::Vector3d edge = points_.row(sides[0].high).transpose() - origin;
    const Eigen::Vector3d axis = edge.stableNormalized();
    // An edge of no length has no around: all angles are zero then.
    Eigen::Vector3d x = Eigen::Vector3d::Zero(), y = x;
    if (!axis.isZero(0)) {
      x = axis.unitOrthogonal();
      y = axis.cross(x);
    }
    places_.clear();
    for (const Side& side : sides) {
      const int opposite = triangles_[side.triangle][(side.side + 2) % 3];
      const Eigen::Vector3d out = points_.row(opposite).transpose() - origin;
      // The mesh has an up: that side of a triangle from which its corners, by ascending number,
      // turn counter-clockwise. Copies of a triangle lie upwards by number, at each of its sides.
      const bool up_is_ahead = opposite < side.low || opposite > side.high;
      places_.push_back({std::atan2(y.dot(out), x.dot(out)), opposite,
                         up_is_ahead ? side.triangle : -side.triangle, side});
    }
    std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) {
      return std::tie(a.angle, a.opposite, a.layer) < std::tie(b.angle, b.opposite, b.layer);
    });
    for (size_t i = 0; i < sides.size(); ++i)
      sides[i] = places_[i].side;
  }

 private:
  struct Place {
    double angle = 0;
    int opposite = 0, layer = 0;
    Side side;
  };

  const PointMatrix& points_;
  std::span<const Triangle> triangles_;
  Vector<Place> places_;
};

// Halfedges of the cover over one side: the front goes around the triangle as it is wound, the back
// the other way.
int FrontHalfedge(const Side& side) {
  return 6 * side.triangle + side.side;
}

int BackHalfedge(const Side& side) {
  return 6 * side.triangle + 5 - side.side;
}

}  // namespace

SideLengths MollifiedLengths(const PointMatrix& points, std::span<const Triangle> triangles) {
  SideLengths result;
  result.sides.reserve(triangles.size());
  double sum = 0;
  for (const Triangle& triangle : triangles) {
    std::array<double, 3> sides{};
    for (int i = 0; i < 3; ++i) {
      sides[i] = (points.row(triangle[(i + 1) % 3]) - points.row(triangle[i])).stableNorm();
      sum += sides[i];
    }
    result.sides.push_back(sides);
  }
  const double mean = sum / (3 * static_cast<double>(triangles.size()));
  const bool has_size = mean > 0 && std::isfinite(mean);
  if (has_size) result.unit = mean;
  double lengthening = 0;
  for (std::array<double, 3>& sides : result.sides) {
    for (double& side : sides)
      side = has_size ? side / mean : 1;
    const double longest = std::max({sides[0], sides[1], sides[2]});
    const double margin = sides[0] + sides[1] + sides[2] - 2 * longest;
    lengthening = std::max(lengthening, kMollification - margin);
  }
  for (std::array<double, 3>& sides : result.sides) {
    for (double& side : sides)
      side += lengthening;
  }
  return result;
}

IntrinsicTriangulation TuftedCover(const PointMatrix& points, std::span<const Triangle> triangles,
                                   const SideLengths& lengths) {
  IntrinsicTriangulation cover;
  cover.tail.resize(6 * triangles.size());
  cover.twin.resize(6 * triangles.size());
  cover.length.resize(6 * triangles.size());
  Vector<Side> sides = SidesByEdge(triangles);
  for (const Side& side : sides) {
    const Triangle& triangle = triangles[side.triangle];
    const int front = FrontHalfedge(side), back = BackHalfedge(side);
    cover.tail[front] = triangle[side.side];
    cover.tail[back] = triangle[(side.side + 1) % 3];
    cover.length[front] = cover.length[back] = lengths.sides[side.triangle][side.side];
  }
  AroundEdge around(points, triangles);
  for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && SameEdge(sides[end], sides[begin]))
      ++end;
    const std::span<Side> here(sides.data() + begin, end - begin);
    if (here.size() > 2) around.Sort(here);
    for (size_t i = 0; i < here.size(); ++i) {
      const Side& side = here[i];
      const Side& next = here[(i + 1) % here.size()];
      // Seen with the triangle on its left, the halfedge from low to high looks ahead.
      const bool front_ahead = triangles[side.triangle][side.side] == side.low;
      const bool next_front_ahead = triangles[next.triangle][next.side] == next.low;
      const int ahead = front_ahead ? FrontHalfedge(side) : BackHalfedge(side);
      const int behind = next_front_ahead ? BackHalfedge(next) : FrontHalfedge(next);
      cover.twin[ahead] = behind;
      cover.twin[behind] = ahead;
    }
  }
  return cover;
}

}  // namespace limber::geometry
